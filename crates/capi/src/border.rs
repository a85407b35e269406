//! Addresses of C become Rust, checked: NULL, alignment, sizes and versions. What cannot be checked - that an address
//! points to as much memory as was said - is the promise of the caller of each exported function.

use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::path::PathBuf;
use std::slice;

use crate::status::{Failure, Outcome, Status, bad_argument};

/// A struct that a caller of another version may have shorter or longer.
///
/// # Safety
/// It is `repr(C)`, its first field is a `usize`, and where it is read, every pattern of bits is a value.
pub unsafe trait Versioned: Copy {
    /// Its size in its first version, bytes.
    const FIRST: usize = size_of::<Self>();
}

/// A struct of more bytes is none.
const LARGEST_STRUCT: usize = 1 << 16;

/// Where a result goes.
pub struct Out<'a, T>(&'a mut MaybeUninit<T>);

impl<T> Out<'_, T> {
    /// Gives the caller a result.
    pub fn set(self, value: T) {
        self.0.write(value);
    }
}

fn check<T>(pointer: *const T, name: &str) -> Outcome {
    if pointer.is_null() {
        return Err(bad_argument(name, "NULL; it must point to something"));
    }
    if !pointer.is_aligned() {
        let reason = format!("it must lie at a multiple of {} bytes", align_of::<T>());
        return Err(bad_argument(name, &reason));
    }
    Ok(())
}

/// Takes the place of a result.
///
/// # Safety
/// The pointer is NULL, or points to memory of the size of a `T` that nothing else uses meanwhile.
pub unsafe fn out<'a, T>(pointer: *mut T, name: &str) -> Outcome<Out<'a, T>> {
    check(pointer, name)?;
    // SAFETY: it is aligned and not null; the rest is the caller's promise.
    Ok(Out(unsafe { &mut *pointer.cast::<MaybeUninit<T>>() }))
}

/// Takes a text in UTF-8; `None` for NULL.
///
/// # Safety
/// The pointer is NULL, or points to bytes that end with a 0 and that nothing changes meanwhile.
pub unsafe fn optional_text<'a>(pointer: *const c_char, name: &str) -> Outcome<Option<&'a str>> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller's promise.
    let text = unsafe { CStr::from_ptr(pointer) };
    match text.to_str() {
        Ok(text) => Ok(Some(text)),
        Err(error) => {
            let at = error.valid_up_to();
            let reason = format!("no UTF-8 at byte {at}; give the text in UTF-8");
            Err(bad_argument(name, &reason))
        }
    }
}

/// Takes a text in UTF-8.
///
/// # Safety
/// As [`optional_text`].
pub unsafe fn text<'a>(pointer: *const c_char, name: &str) -> Outcome<&'a str> {
    // SAFETY: the caller's promise.
    unsafe { optional_text(pointer, name) }?
        .ok_or_else(|| bad_argument(name, "NULL; it must point to something"))
}

/// Takes the name of a file, which is not empty: on Unix any bytes, elsewhere UTF-8.
///
/// # Safety
/// As [`optional_text`].
pub unsafe fn file(pointer: *const c_char, name: &str) -> Outcome<PathBuf> {
    // SAFETY: the caller's promise.
    let path = unsafe { path(pointer, name) }?;
    match path.as_os_str().is_empty() {
        true => Err(bad_argument(name, "it is empty; give the path of a file")),
        false => Ok(path),
    }
}

/// Takes the name of a file or a folder, which may be empty.
///
/// # Safety
/// As [`optional_text`].
pub unsafe fn path(pointer: *const c_char, name: &str) -> Outcome<PathBuf> {
    check(pointer, name)?;
    #[cfg(unix)]
    {
        use std::os::unix::ffi::OsStrExt;
        // SAFETY: the caller's promise.
        let bytes = unsafe { CStr::from_ptr(pointer) }.to_bytes();
        Ok(PathBuf::from(std::ffi::OsStr::from_bytes(bytes)))
    }
    #[cfg(not(unix))]
    // SAFETY: the caller's promise.
    Ok(PathBuf::from(unsafe { text(pointer, name) }?))
}

fn check_values<T>(pointer: *const T, count: usize, name: &str) -> Outcome {
    check(pointer, name)?;
    match count.checked_mul(size_of::<T>()) {
        Some(bytes) if isize::try_from(bytes).is_ok() => Ok(()),
        _ => Err(bad_argument(name, "more bytes than there can be")),
    }
}

/// Takes values that the caller has; none need no memory.
///
/// # Safety
/// The pointer points to so many values, which nothing changes meanwhile, or is NULL.
pub unsafe fn values<'a, T>(pointer: *const T, count: usize, name: &str) -> Outcome<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check_values(pointer, count, name)?;
    // SAFETY: it is aligned, not null, and not too long; the rest is the caller's promise.
    Ok(unsafe { slice::from_raw_parts(pointer, count) })
}

/// Takes memory of so many values, to be written; every pattern of bits is a value of them.
///
/// # Safety
/// The pointer points to so much memory, which nothing else uses meanwhile, or is NULL.
pub unsafe fn values_mut<'a, T>(pointer: *mut T, count: usize, name: &str) -> Outcome<&'a mut [T]> {
    if count == 0 {
        return Ok(&mut []);
    }
    check_values(pointer, count, name)?;
    // SAFETY: it is aligned, not null, and not too long; the rest is the caller's promise.
    Ok(unsafe { slice::from_raw_parts_mut(pointer, count) })
}

/// Reads a struct; what an older caller's is shorter is 0, and what a newer caller's is longer must be.
///
/// # Safety
/// The pointer is NULL, or points to as many bytes as the first field says, which nothing changes meanwhile.
pub unsafe fn read_struct<T: Versioned>(pointer: *const T, name: &str) -> Outcome<T> {
    check(pointer, name)?;
    // SAFETY: the first field is the size.
    let size = unsafe { pointer.cast::<usize>().read() };
    check_size(size, T::FIRST, name)?;
    let own = size_of::<T>();
    // SAFETY: the caller's promise.
    let bytes = unsafe { slice::from_raw_parts(pointer.cast::<u8>(), size) };
    if bytes.iter().skip(own).any(|byte| *byte != 0) {
        let message = format!(
            "{name}: struct_size {size}, this library knows {own} bytes, and what it does not know is not 0; update \
             the library, or leave out what is new"
        );
        return Err(Failure::Call(Status::BadVersion, message));
    }
    let mut value = MaybeUninit::<T>::zeroed();
    // SAFETY: both have so many bytes, and 0 is a value of what is not copied.
    unsafe {
        let target = value.as_mut_ptr().cast::<u8>();
        target.copy_from_nonoverlapping(bytes.as_ptr(), size.min(own));
        Ok(value.assume_init())
    }
}

/// Reads structs that lie one behind the other, each as large as the first says that it is; none need no memory.
///
/// # Safety
/// The pointer is NULL, or points to so many structs, which nothing changes meanwhile.
pub unsafe fn read_structs<T: Versioned>(
    first: *const T,
    count: u32,
    name: &str,
) -> Outcome<Vec<T>> {
    if count == 0 {
        return Ok(Vec::new());
    }
    check(first, name)?;
    // SAFETY: the first field is the size.
    let size = unsafe { first.cast::<usize>().read() };
    let read = |index: usize| {
        let name = format!("{name}[{index}]");
        let pointer = first.wrapping_byte_add(index * size);
        check(pointer, &name)?;
        // SAFETY: the caller's promise, twice.
        let (own, value) = unsafe {
            let own = pointer.cast::<usize>().read();
            (own, read_struct(pointer, &name)?)
        };
        match own == size {
            true => Ok(value),
            false => {
                let message = format!(
                    "{name}: struct_size {own}, that of the first is {size}; give all of an array the same"
                );
                Err(Failure::Call(Status::BadVersion, message))
            }
        }
    };
    (0..count as usize).map(read).collect()
}

/// Writes a struct, as much as the caller has of it; its first field stays.
///
/// # Safety
/// The pointer is NULL, or points to as many bytes as the first field says, which nothing else uses meanwhile.
pub unsafe fn write_struct<T: Versioned>(pointer: *mut T, name: &str, value: T) -> Outcome {
    check(pointer, name)?;
    // SAFETY: the first field is the size.
    let size = unsafe { pointer.cast::<usize>().read() };
    check_size(size, T::FIRST, name)?;
    let behind = size_of::<usize>();
    // SAFETY: both have so many bytes.
    unsafe {
        let source = (&raw const value).cast::<u8>().add(behind);
        let target = pointer.cast::<u8>().add(behind);
        target.copy_from_nonoverlapping(source, size.min(size_of::<T>()) - behind);
    }
    Ok(())
}

/// Checks the size that a caller says a struct has. `first` is what it had in its first version.
fn check_size(size: usize, first: usize, name: &str) -> Outcome {
    if (first..=LARGEST_STRUCT).contains(&size) {
        return Ok(());
    }
    let message = format!(
        "{name}: struct_size {size}; it must be the struct's sizeof, which was {first} at the least"
    );
    Err(Failure::Call(Status::BadVersion, message))
}
