//! Devices: which there are, and which one is meant.

use energywave::{Device, DeviceType, Devices};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::{exception, warn};

/// Names the device where nothing else does, as for the program.
const VARIABLE: &str = "ENERGYWAVE_DEVICE";

/// Devices, a dictionary each; why there is none of OpenCL; what is said of drivers without one.
type Found<'py> = (Vec<Bound<'py, PyDict>>, Option<String>, Vec<String>);

/// Returns all devices.
#[pyfunction]
pub fn devices(py: Python<'_>) -> PyResult<Found<'_>> {
    let found = py.detach(Devices::discover);
    let all = found.as_slice().iter().map(|device| record(py, device));
    let problem = found.problem().map(str::to_owned);
    Ok((
        all.collect::<PyResult<_>>()?,
        problem,
        found.absent().to_vec(),
    ))
}

/// Returns what is known of a device, by the names that the program prints.
pub fn record<'py>(py: Python<'py>, device: &Device) -> PyResult<Bound<'py, PyDict>> {
    let record = PyDict::new(py);
    record.set_item("index", device.index)?;
    record.set_item("name", &device.name)?;
    record.set_item("type", device.device_type.to_string())?;
    record.set_item("platform", &device.platform)?;
    record.set_item("version", &device.version)?;
    record.set_item("driver", &device.driver)?;
    record.set_item("compute_units", device.compute_units)?;
    record.set_item("memory_bytes", device.memory_bytes)?;
    record.set_item("max_allocation_bytes", device.max_allocation_bytes)?;
    record.set_item("lanes", device.lanes)?;
    record.set_item("tile_workers", device.tile_workers)?;
    record.set_item("default", device.default)?;
    Ok(record)
}

/// Returns the devices that a word chooses, else the environment, else the best; warns where that is the reference. No
/// driver is loaded where the reference is asked for.
pub fn choose(py: Python<'_>, choice: Option<&str>) -> PyResult<Vec<Device>> {
    let variable = std::env::var(VARIABLE).unwrap_or_default();
    let choice = choice.or(Some(variable.as_str()).filter(|word| !word.is_empty()));
    if choice.is_some_and(|word| word.trim().eq_ignore_ascii_case("reference")) {
        return Ok(vec![Device::reference()]);
    }
    let found = py.detach(Devices::discover);
    if let Some(word) = choice {
        return found
            .select_all(word)
            .map_err(|error| exception(py, &error));
    }
    let best = found.best_or_reference();
    if best.device_type == DeviceType::Reference {
        let problem = match found.problem() {
            Some(problem) => problem.to_owned(),
            None => found.absent().join("; "),
        };
        let message = format!(
            "{problem}; the built-in reference draws, hundreds of times slower (device=\"reference\" asks for it)"
        );
        warn(py, "NoDeviceWarning", &message)?;
    }
    Ok(vec![best])
}
