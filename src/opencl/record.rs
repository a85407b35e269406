//! What is known of a program from earlier starts: its binary, and that its kernels passed the self-test. Without the
//! feature `kernel-cache` nothing is known.

use super::{OpenClDevice, RendererOptions};

#[cfg(feature = "kernel-cache")]
mod kept {
    use super::*;
    use crate::opencl::cache::Folder;
    use crate::opencl::key::ProgramKey;

    /// The kinds of the cache's entries: the binary, and that the kernels passed the self-test.
    const BINARY: &str = "bin";
    const TESTED: &str = "tested";

    /// The entries of a program.
    #[derive(Debug)]
    pub(crate) struct Record {
        key: ProgramKey,
        /// For binaries, if they are to be kept.
        folder: Option<Folder>,
    }

    impl Record {
        pub(crate) fn new(
            device: &OpenClDevice,
            text: &str,
            flags: &str,
            options: &RendererOptions,
        ) -> Self {
            Self {
                key: ProgramKey::new(device, text, flags),
                folder: options.cache.folder(device),
            }
        }

        pub(crate) fn binary(&self) -> Option<Vec<u8>> {
            self.folder.as_ref()?.read(self.key, BINARY)
        }

        pub(crate) fn keep_binary(&self, binary: impl FnOnce() -> Option<Vec<u8>>) {
            if let Some(folder) = &self.folder
                && let Some(binary) = binary()
            {
                let _ = folder.write(self.key, BINARY, &binary); // kept or not, the program is built
            }
        }

        pub(crate) fn was_tested(&self) -> bool {
            Folder::of_user().is_some_and(|folder| folder.read(self.key, TESTED).is_some())
        }

        pub(crate) fn mark_tested(&self) {
            if let Some(folder) = Folder::of_user() {
                let _ = folder.write(self.key, TESTED, &[]); // else it is tested again
            }
        }
    }
}

#[cfg(not(feature = "kernel-cache"))]
mod kept {
    use super::*;

    /// Nothing.
    #[derive(Debug)]
    pub(crate) struct Record;

    impl Record {
        pub(crate) fn new(_: &OpenClDevice, _: &str, _: &str, _: &RendererOptions) -> Self {
            Self
        }

        pub(crate) fn binary(&self) -> Option<Vec<u8>> {
            None
        }

        pub(crate) fn keep_binary(&self, _: impl FnOnce() -> Option<Vec<u8>>) {}

        pub(crate) fn was_tested(&self) -> bool {
            false
        }

        pub(crate) fn mark_tested(&self) {}
    }
}

pub(super) use kept::Record;
