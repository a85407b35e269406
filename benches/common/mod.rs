//! What the benches with records share.

use energywave::{Device, Renderer};

/// The device to measure: `ENERGYWAVE_DEVICE`, else a CPU, with a renderer.
pub fn device() -> (Device, Renderer) {
    let choice = std::env::var("ENERGYWAVE_DEVICE").unwrap_or_else(|_| "cpu".to_owned());
    let device = Device::select(&choice).unwrap();
    let renderer = Renderer::new(&device).unwrap();
    (device, renderer)
}

/// The beginning of a record: what was measured, and on what.
pub fn header(device: &Device, command: &str) -> String {
    let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpu.lines().find_map(|line| line.strip_prefix("model name"));
    format!(
        "Frames a second, whole frames with the image in host memory, a new camera for every frame.\n\n\
         * device: {}, {} compute units, {} lanes\n* platform: {}, {}, driver {}\n* processor: {}\n\
         * command: `{command}`\n",
        device.name,
        device.compute_units,
        device.lanes,
        device.platform,
        device.version,
        device.driver,
        model.map_or("unknown", |line| line.trim_start_matches(['\t', ' ', ':'])),
    )
}
