//! The table of kinds: one row for each kind of source.
//!
//! A row gives the kind's name, which is its key in scene files, its module in every folder and its name in OpenCL C;
//! its type; and its list in a [`Scene`](super::Scene). Everything that is made for each kind is made from these rows:
//! the scene's lists and the file's keys, the reference's fields, the packed lists, the kernels' parameters and the
//! generated `kinds.h`. ARCHITECTURE.md says what else a kind needs.

/// Hands the rows of the table to a macro. The order is that in which light is summed.
macro_rules! for_each_kind {
    ($then:ident) => {
        $then! {
            /// Points of light.
            sphere: Sphere, spheres;
            /// Infinite lines of light.
            cylinder: Cylinder, cylinders;
            /// Half-lines of light.
            beam: Beam, beams;
            /// Rings of light.
            torus: Torus, tori;
            /// Quadratic curves of light.
            curve: Curve, curves;
            /// Finite lines of light.
            segment: Segment, segments;
            /// Chains of light.
            path: LightPath, paths;
        }
    };
}
pub(crate) use for_each_kind;

macro_rules! name_kinds {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// Number of kinds.
        pub(crate) const KIND_COUNT: usize = [$(stringify!($kind)),*].len();

        /// The names of all kinds, in the order of the table.
        pub(crate) const KINDS: [&str; KIND_COUNT] = [$(stringify!($kind)),*];
    };
}
for_each_kind!(name_kinds);
