//! Devices: all of them as JSON, one as a struct.

use std::collections::BTreeMap;
use std::ffi::{CString, c_char};
use std::sync::{Mutex, PoisonError};

use energywave::{Device, Devices};

use crate::border::{self, Versioned};
use crate::status::{Failure, Outcome, Status, guarded, text};

/// A device. Texts are UTF-8, end with a 0, and are cut where they are longer.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct DeviceInfo {
    /// `sizeof` of this struct, set by the caller.
    pub struct_size: usize,
    /// Its place among all devices; it may change when drivers are installed.
    pub index: u32,
    /// 1 if it is the one that is chosen where nothing else is said, else 0.
    pub is_default: u32,
    /// Memory, bytes.
    pub memory_bytes: u64,
    /// The largest single allocation, bytes.
    pub max_allocation_bytes: u64,
    /// Compute units, or threads.
    pub compute_units: u32,
    /// Rays that a work-item carries side by side.
    pub lanes: u32,
    /// `gpu`, `cpu`, `accelerator` or `reference`.
    pub device_type: [c_char; 16],
    /// Its name.
    pub name: [c_char; 128],
    /// The name of its OpenCL platform.
    pub platform: [c_char; 128],
    /// Its OpenCL version.
    pub version: [c_char; 128],
    /// The version of its driver.
    pub driver: [c_char; 64],
}

// SAFETY: it begins with its size, and its fields are numbers.
unsafe impl Versioned for DeviceInfo {}

/// Texts that callers have, by their addresses.
static TEXTS: Mutex<BTreeMap<usize, CString>> = Mutex::new(BTreeMap::new());

/// Keeps a text for the caller, who frees it.
pub fn give_text(given: &str) -> *mut c_char {
    let kept = text(given);
    let pointer = kept.as_ptr().cast_mut();
    let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
    texts.insert(pointer.addr(), kept);
    pointer
}

/// Gives all devices as a JSON text, an array of objects: `index`, `name`, `type`, `platform`, `version`, `driver`,
/// `compute_units`, `memory_bytes`, `max_allocation_bytes`, `form`, `lanes`, `tile_workers`, `default`. The last is the
/// built-in reference, so that there is always one. `*json` is freed by energywave_text_free.
///
/// # Safety
/// `json` points to a place for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_devices(json: *mut *mut c_char) -> Status {
    guarded(|| {
        // SAFETY: the caller's promise.
        let json = unsafe { border::out(json, "json") }?;
        let devices = Devices::discover();
        let text = serde_json::to_string(&devices)
            .map_err(|error| Failure::Call(Status::Internal, error.to_string()))?;
        json.set(give_text(&text));
        Ok(())
    })
}

/// Frees a text that this library gave; NULL is none.
///
/// # Safety
/// Nothing uses the text any more. Any other pointer is an error, ENERGYWAVE_STATUS_BAD_HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_text_free(text: *mut c_char) -> Status {
    guarded(|| {
        if text.is_null() {
            return Ok(());
        }
        let mut texts = TEXTS.lock().unwrap_or_else(PoisonError::into_inner);
        match texts.remove(&text.addr()) {
            Some(_) => Ok(()),
            None => {
                let message =
                    "text: it was freed, or this library never gave it; free what it gives, once";
                Err(Failure::Call(Status::BadHandle, message.to_owned()))
            }
        }
    })
}

/// Tells about the device that a choice names; see energywave_renderer_new. `info` has its `struct_size` set.
///
/// # Safety
/// `choice` is NULL or ends with a 0; `info` points to as many bytes as it says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_device_describe(
    choice: *const c_char,
    info: *mut DeviceInfo,
) -> Status {
    guarded(|| {
        // SAFETY: the caller's promise.
        let choice = unsafe { border::optional_text(choice, "choice") }?;
        let devices = Devices::discover();
        let device = match choice {
            Some(choice) => devices.select(choice)?,
            None => devices.best_or_reference(),
        };
        // SAFETY: the same.
        unsafe { border::write_struct(info, "info", described(&device)) }
    })
}

/// Returns the devices that a choice names: one, or several with commas between, or `all`.
pub fn chosen(choice: Option<&str>) -> Outcome<Vec<Device>> {
    let devices = Devices::discover();
    let Some(choice) = choice else {
        return Ok(vec![devices.best()?]);
    };
    let is_list = choice.contains(',') || choice.trim().eq_ignore_ascii_case("all");
    match devices.select(choice) {
        Ok(device) => Ok(vec![device]),
        Err(_) if is_list => Ok(devices.select_all(choice)?),
        Err(error) => Err(error.into()),
    }
}

fn described(device: &Device) -> DeviceInfo {
    DeviceInfo {
        struct_size: 0,
        index: u32::try_from(device.index).unwrap_or(u32::MAX),
        is_default: device.default.into(),
        memory_bytes: device.memory_bytes,
        max_allocation_bytes: device.max_allocation_bytes,
        compute_units: device.compute_units,
        lanes: device.lanes,
        device_type: array(&device.device_type.to_string()),
        name: array(&device.name),
        platform: array(&device.platform),
        version: array(&device.version),
        driver: array(&device.driver),
    }
}

/// Returns a text that ends with a 0, cut between two characters where it is too long.
fn array<const N: usize>(text: &str) -> [c_char; N] {
    let mut end = text.len().min(N - 1);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    let mut array = [0; N];
    for (place, byte) in array.iter_mut().zip(text[..end].bytes()) {
        *place = byte.cast_signed() as c_char;
    }
    array
}
