//! `energywave devices`: what there is to compute on.

use energywave::{Device, DeviceType, Devices};

use super::subcommands::DevicesArguments;
use super::{Outcome, note, print, print_json};

pub fn run(arguments: &DevicesArguments) -> Outcome {
    let devices = Devices::discover();
    if arguments.json {
        print_json(&devices)?;
    } else {
        print(&table(devices.as_slice()))?;
        let best = devices.best_or_reference();
        note(&format!("default: {best}: {}", reason(&best)));
    }
    match devices.problem() {
        Some(problem) => note(&format!("OpenCL: {problem}")),
        None => {
            let absent = devices.absent().iter();
            absent.for_each(|reason| note(&format!("OpenCL: {reason}")));
        }
    }
    Ok(())
}

/// Returns a text with one row for each device.
fn table(devices: &[Device]) -> String {
    let mut text = format!(
        "{:>5} {:<11} {:>5} {:>10} {:<4} {:>5} {:>7}  name, platform, version, driver\n",
        "index", "type", "units", "memory", "form", "lanes", "workers"
    );
    for device in devices {
        text += &format!(
            "{:>5} {:<11} {:>5} {:>6} MiB {:<4} {:>5} {:>7}  {}, {}, {}, {}\n",
            device.index,
            device.device_type,
            device.compute_units,
            device.memory_bytes >> 20,
            device.form,
            device.lanes,
            device.tile_workers,
            device.name,
            device.platform,
            device.version,
            device.driver
        );
    }
    text
}

fn reason(best: &Device) -> &'static str {
    match best.device_type {
        DeviceType::Gpu => "the GPU with the most compute units",
        DeviceType::Cpu => "no GPU has an OpenCL driver, so the CPU through OpenCL",
        _ => "no GPU or CPU has an OpenCL driver",
    }
}
