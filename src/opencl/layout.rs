//! Structs that cross to the device. Each is written twice, here and in OpenCL C, in the same order: sizes and offsets
//! are asserted at compile time, sizes again beside the struct in `cl/` at every program build, and every field by name
//! in the tests.

/// Name, size and fields of a struct that crosses to the device.
#[derive(Debug, Clone, Copy)]
pub struct StructLayout {
    /// Its name.
    pub name: &'static str,
    /// Its size, bytes.
    pub size: usize,
    /// Name, offset and size of every field, bytes.
    pub fields: &'static [(&'static str, usize, usize)],
}

/// A struct that crosses to the device.
pub trait DeviceStruct: bytemuck::Pod + PartialEq {
    /// How the device finds its fields.
    const LAYOUT: StructLayout;
}

/// Defines a struct of 32-bit numbers with its size and the offset of each field, bytes.
macro_rules! device_struct {
    ($(#[$meta:meta])* $name:ident [$size:expr] { $($field:ident: $type:ty = $offset:expr),* $(,)? }) => {
        $(#[$meta])*
        #[allow(missing_docs)] // the struct in cl/, which this mirrors, says what each field holds
        #[repr(C, align(4))]
        #[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name { $(pub $field: $type),* }
        const _: () = assert!(size_of::<$name>() == $size);
        $(const _: () = assert!(std::mem::offset_of!($name, $field) == $offset);)*
        impl $crate::opencl::DeviceStruct for $name {
            const LAYOUT: $crate::opencl::StructLayout = $crate::opencl::StructLayout {
                name: stringify!($name),
                size: $size,
                fields: &[$((stringify!($field), $offset, size_of::<$type>())),*],
            };
        }
    };
}
pub(crate) use device_struct;
