//! The choice of a device: OpenCL's devices and the built-in reference, by index, by type or by part of a name.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::error::{Error, Result};
use crate::memory;
use crate::opencl::{DeviceForm, DeviceType, Discovery, OpenClDevice, RendererOptions, discover};
use crate::shown::shown;
use crate::threads;
use crate::wave::tile_workers;

/// A device that can render. Serialises to the record that `energywave devices --json` prints.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Device {
    /// Position in [`Device::list`]; it may change when drivers are installed.
    pub index: usize,
    /// Name.
    pub name: String,
    /// Kind.
    #[serde(rename = "type")]
    pub device_type: DeviceType,
    /// Name of its OpenCL platform.
    pub platform: String,
    /// OpenCL version.
    pub version: String,
    /// Driver version.
    pub driver: String,
    /// Compute units, or threads.
    pub compute_units: u32,
    /// Memory in bytes.
    pub memory_bytes: u64,
    /// Largest single allocation in bytes.
    pub max_allocation_bytes: u64,
    /// How kernels are built for it and launched; the environment variable `ENERGYWAVE_FORM` forces it for all devices.
    pub form: DeviceForm,
    /// Rays that a work-item carries side by side.
    pub lanes: u32,
    /// Work-items that share a tile.
    pub tile_workers: u32,
    /// Whether it is chosen where nothing else is said.
    pub default: bool,
    #[serde(skip)]
    pub(crate) backend: Backend,
}

/// What a device computes with.
#[derive(Debug, Clone)]
pub(crate) enum Backend {
    OpenCl(OpenClDevice),
    Reference,
}

/// Every device, and why there is no OpenCL device if there is none.
#[derive(Debug, Clone, Serialize)]
#[serde(transparent)]
pub struct Devices {
    #[serde(serialize_with = "as_list")]
    list: Vec<Device>,
    #[serde(skip)]
    problem: Option<String>,
    #[serde(skip)]
    absent: Vec<String>,
}

fn as_list<S: Serializer>(list: &[Device], writer: S) -> std::result::Result<S::Ok, S::Error> {
    list.serialize(writer)
}

impl Device {
    /// Lists every device: GPUs, then other OpenCL devices, then the built-in reference.
    #[must_use]
    pub fn list() -> Vec<Self> {
        Devices::discover().list
    }

    /// Chooses the device that `choice` names: an index, `gpu`, `cpu`, `reference`, or a part of a device's name or
    /// platform, upper or lower case.
    ///
    /// # Errors
    /// [`Error::NoSuchDevice`] if none fits or several do.
    pub fn select(choice: &str) -> Result<Self> {
        Devices::discover().select(choice)
    }

    /// Chooses the best OpenCL device: the GPU with the most compute units, else a CPU.
    ///
    /// # Errors
    /// [`Error::NoSuchDevice`] if there is none, with what to install. The built-in reference is hundreds of times
    /// slower than any of them: whoever wants it asks for [`Device::reference`].
    pub fn best() -> Result<Self> {
        Devices::discover().best()
    }

    /// Returns the built-in reference: float64 on all cores, without OpenCL.
    #[must_use]
    pub fn reference() -> Self {
        reference(0)
    }
}

impl Devices {
    /// Looks for devices.
    #[must_use]
    pub fn discover() -> Self {
        let Discovery {
            devices,
            problem,
            absent,
        } = discover();
        let mut list: Vec<Device> = devices
            .into_iter()
            .enumerate()
            .map(|(index, device)| from_opencl(index, device))
            .collect();
        list.push(reference(list.len()));
        let best = best_index(&list);
        for device in &mut list {
            device.default = device.index == best;
        }
        Self {
            list,
            problem,
            absent,
        }
    }

    /// Returns all of them, in the order of their indices; the last is the built-in reference.
    #[must_use]
    pub fn as_slice(&self) -> &[Device] {
        &self.list
    }

    /// Says why no OpenCL device was found, and what to install; `None` if one was.
    #[must_use]
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    /// Says of every driver that shows no device that can draw why, and what to do, a line each.
    #[must_use]
    pub fn absent(&self) -> &[String] {
        &self.absent
    }

    /// Chooses the best OpenCL device, as [`Device::best`] does.
    ///
    /// # Errors
    /// [`Error::NoSuchDevice`] if there is no OpenCL device.
    pub fn best(&self) -> Result<Device> {
        let best = self.best_or_reference();
        match best.device_type {
            DeviceType::Reference => Err(self.none("of OpenCL")),
            _ => Ok(best),
        }
    }

    /// Chooses the best OpenCL device, or the built-in reference where there is none, as the program does.
    #[must_use]
    pub fn best_or_reference(&self) -> Device {
        self.list[best_index(&self.list)].clone()
    }

    /// Chooses the device that `choice` names, as [`Device::select`] does.
    ///
    /// # Errors
    /// [`Error::NoSuchDevice`] if none fits or several do.
    pub fn select(&self, choice: &str) -> Result<Device> {
        let word = choice.trim().to_lowercase();
        let fitting: Vec<&Device> = match word.as_str() {
            "reference" => self.of_type(DeviceType::Reference),
            "gpu" => self.of_type(DeviceType::Gpu).into_iter().take(1).collect(),
            "cpu" => self.of_type(DeviceType::Cpu).into_iter().take(1).collect(),
            // No name is found by a comma or a blank alone.
            word if !word.contains(char::is_alphanumeric) => Vec::new(),
            word => match word.parse::<usize>() {
                Ok(index) => self.list.get(index).into_iter().collect(),
                Err(_) => self.by_name(word),
            },
        };
        match fitting.as_slice() {
            [device] => Ok((*device).clone()),
            [] => Err(self.none(&format!("\"{}\"", shown(choice)))),
            several => Err(Error::NoSuchDevice(format!(
                "\"{}\" fits {} devices, choose one by its index or a longer part of its name:{}",
                shown(choice),
                several.len(),
                listed(several.iter().copied())
            ))),
        }
    }

    /// Chooses the devices that `choice` names: `all`, every OpenCL device but simulators and
    /// those whose driver is known not to draw; or a list of what
    /// [`Device::select`] takes, with commas between, such as `0,1` or `gpu,cpu`.
    ///
    /// # Errors
    /// [`Error::NoSuchDevice`] if there is none for a part of the choice, several, or one that is there already.
    pub fn select_all(&self, choice: &str) -> Result<Vec<Device>> {
        if choice.trim().eq_ignore_ascii_case("all") {
            let is_real = |device: &&Device| {
                device.device_type != DeviceType::Reference && !device.is_shunned()
            };
            let all: Vec<Device> = self.list.iter().filter(is_real).cloned().collect();
            return match all.is_empty() {
                true => Err(self.none("\"all\"")),
                false => Ok(all),
            };
        }
        let mut devices: Vec<Device> = Vec::new();
        for word in choice.split(',') {
            let device = self.select(word)?;
            if devices.iter().any(|there| there.index == device.index) {
                return Err(Error::NoSuchDevice(format!(
                    "\"{}\" names a device twice: {device}",
                    shown(choice)
                )));
            }
            devices.push(device);
        }
        Ok(devices)
    }

    /// Makes the error of a choice that nothing answers to.
    fn none(&self, choice: &str) -> Error {
        let problem = match &self.problem {
            Some(problem) => format!(" ({problem})"),
            None => String::new(),
        };
        Error::NoSuchDevice(format!(
            "no device {choice}{problem}; there are:{}",
            listed(self.list.iter())
        ))
    }

    /// Returns the devices of a type, the best first; a simulator only where there is no real one.
    fn of_type(&self, device_type: DeviceType) -> Vec<&Device> {
        let mut fitting: Vec<&Device> = self
            .list
            .iter()
            .filter(|device| device.device_type == device_type)
            .collect();
        fitting
            .sort_by_key(|device| (device.is_shunned(), std::cmp::Reverse(device.compute_units)));
        fitting
    }

    /// Returns the devices whose name has `word` in it; if there are none, those whose platform or version has.
    fn by_name(&self, word: &str) -> Vec<&Device> {
        let fitting = |text: fn(&Device) -> String| -> Vec<&Device> {
            let has_word = |device: &&Device| text(device).to_lowercase().contains(word);
            self.list.iter().filter(has_word).collect()
        };
        let by_name = fitting(|device| device.name.clone());
        if by_name.is_empty() {
            fitting(|device| format!("{} {}", device.platform, device.version))
        } else {
            by_name
        }
    }
}

impl Device {
    /// Returns whether it is a simulator, or its driver is known not to draw.
    fn is_shunned(&self) -> bool {
        let is_shunned = |it: &OpenClDevice| it.is_simulator || it.known_fault.is_some();
        matches!(&self.backend, Backend::OpenCl(device) if is_shunned(device))
    }
}

/// Returns the place of the best GPU, else of the best CPU, else of the reference.
fn best_index(list: &[Device]) -> usize {
    let rank = |device: &Device| match device.device_type {
        _ if device.is_shunned() => 4,
        DeviceType::Gpu => 0,
        DeviceType::Cpu => 1,
        DeviceType::Reference => 2,
        DeviceType::Accelerator => 3,
    };
    list.iter()
        .min_by_key(|device| (rank(device), std::cmp::Reverse(device.compute_units)))
        .map_or(0, |device| device.index)
}

fn listed<'a>(devices: impl Iterator<Item = &'a Device>) -> String {
    devices.map(|device| format!("\n    {device}")).collect()
}

impl fmt::Display for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (index, name) = (self.index, &self.name);
        write!(
            f,
            "{index}: {name} ({}, {})",
            self.device_type, self.platform
        )
    }
}

fn from_opencl(index: usize, device: OpenClDevice) -> Device {
    Device {
        index,
        name: device.name.clone(),
        device_type: device.device_type,
        platform: device.platform.clone(),
        version: device.version.clone(),
        driver: device.driver.clone(),
        compute_units: device.compute_units,
        memory_bytes: device.memory_bytes,
        max_allocation_bytes: device.max_allocation_bytes,
        form: device.form,
        lanes: device.lanes,
        tile_workers: tile_workers(&device, &RendererOptions::default()),
        default: false,
        backend: Backend::OpenCl(device),
    }
}

fn reference(index: usize) -> Device {
    let memory = memory::total_bytes().unwrap_or(0);
    Device {
        index,
        name: "reference".to_owned(),
        device_type: DeviceType::Reference,
        platform: "built in, float64".to_owned(),
        version: "none".to_owned(),
        driver: env!("CARGO_PKG_VERSION").to_owned(),
        compute_units: threads::count() as u32,
        memory_bytes: memory,
        max_allocation_bytes: memory,
        form: DeviceForm::Cpu,
        lanes: 1,
        tile_workers: 1,
        default: false,
        backend: Backend::Reference,
    }
}
