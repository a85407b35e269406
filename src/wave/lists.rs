//! The lists that kernels read, on the device.

use super::pack::layout::{Node, RayRecord};
use super::pack::{self, PackStamp, Row, Sources};
use crate::error::Result;
use crate::opencl::{Argument, Compute, Uploaded};
use crate::scene::kinds::for_each_kind;

macro_rules! define_lists {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// The lists, each of which is uploaded when it changed.
        #[derive(Debug)]
        pub(super) struct Lists {
            nodes: Uploaded<Node>,
            $($list: Uploaded<pack::$kind::$Type>,)*
            rows: Uploaded<Row>,
            rays: Uploaded<RayRecord>,
            /// Which sources the device has.
            sources: Option<PackStamp>,
        }

        impl Lists {
            pub(super) fn new() -> Self {
                Self {
                    nodes: Uploaded::new("the list of quadrature nodes"),
                    $($list: Uploaded::new(concat!("the list of ", stringify!($list))),)*
                    rows: Uploaded::new("the list of sources' rows"),
                    rays: Uploaded::new("the list of rays"),
                    sources: None,
                }
            }

            /// Makes the device's sources equal to these; `stamp` tells whether they are already.
            pub(super) fn upload_sources(
                &mut self,
                compute: &Compute,
                sources: &Sources,
                stamp: PackStamp,
            ) -> Result<()> {
                let is_known = self.sources.take() == Some(stamp);
                $(self.$list.upload_unless(is_known, compute, &sources.$list)?;)*
                self.rows.upload_unless(is_known, compute, &sources.rows.list)?;
                self.sources = Some(stamp);
                Ok(())
            }

            /// Returns the lists by the names that kernels know them by; of sources, those that there are.
            pub(super) fn named(&self, sources: &Sources) -> Vec<(&'static str, &dyn Argument)> {
                let mut named: Vec<(&str, &dyn Argument)> =
                    vec![("nodes", &self.nodes), ("rows", &self.rows)];
                $(if !sources.$list.is_empty() {
                    named.push((concat!(stringify!($kind), "_list"), &self.$list));
                })*
                named
            }

            /// Waits for copies under way.
            pub(super) fn settle(&mut self, compute: &Compute) -> Result<()> {
                self.nodes.settle(compute)?;
                $(self.$list.settle(compute)?;)*
                self.rows.settle(compute)?;
                self.rays.settle(compute)
            }
        }
    };
}
for_each_kind!(define_lists);

impl Lists {
    /// Makes the device's nodes of a sum equal to these.
    pub(super) fn upload_nodes(&mut self, compute: &Compute, nodes: &[Node]) -> Result<()> {
        self.nodes.upload(compute, nodes)
    }

    /// Makes the device's single rays equal to these.
    pub(super) fn upload_rays(&mut self, compute: &Compute, rays: &[RayRecord]) -> Result<()> {
        self.rays.upload(compute, rays)
    }

    /// Returns the single rays, for kernels.
    pub(super) fn rays(&self) -> &dyn Argument {
        &self.rays
    }
}
