//! `energywave verify`: known rays through a device.

use std::collections::BTreeSet;

use energywave::scene::Method;
use energywave::verify::{DIVISIONS, KnownRay, Row, built_in_rays, rays_from_file, verify};
use energywave::{Device, Renderer, RendererOptions, shown};

use super::args::SLOW_START;
use super::subcommands::VerifyArguments;
use super::{Failure, Outcome, choose_devices, note, print, print_json};

pub fn run(arguments: &VerifyArguments) -> Outcome {
    let rays = match &arguments.rays {
        Some(path) => rays_from_file(path)?,
        None => built_in_rays()?,
    };
    let devices = choose_devices(arguments.device.device.as_deref())?;
    // This command is the longer test, and shows every value.
    let mut options = RendererOptions::default();
    options.skips_self_test = true;
    options.slow_start = Some(SLOW_START);
    name_unknown_kinds(&rays);
    let mut rows = Vec::new();
    for device in &devices {
        let mut renderer = Renderer::with_options(device, &options)?;
        let name = name_among(device, &devices);
        let methods = [
            Method::simpson(DIVISIONS),
            Method::exact(arguments.tolerance),
        ];
        for method in methods {
            rows.extend(verify(&mut renderer, &name, &rays, method)?);
        }
    }
    if arguments.json {
        print_json(&rows)?;
    } else {
        print(&table(&rows))?;
    }
    judge(&rows)
}

/// Names a device, among several with its index: equal devices have equal names.
fn name_among(device: &Device, devices: &[Device]) -> String {
    match devices {
        [_] => device.name.clone(),
        _ => format!("{}: {}", device.index, device.name),
    }
}

fn name_unknown_kinds(rays: &[KnownRay]) {
    let unknown: BTreeSet<&str> = rays
        .iter()
        .filter(|ray| ray.scene.is_none())
        .map(|ray| ray.kind.as_str())
        .collect();
    for kind in unknown {
        note(&format!("kind {}: not built yet, no row", shown(kind)));
    }
}

fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:>5} {:<21} {:<8} {:>14} {:>14} {:>9} {:>8}  device\n",
        "index", "kind", "method", "expected", "value", "error", "limit"
    );
    for row in rows {
        text += &format!(
            "{:>5} {:<21} {:<8} {:>14.8e} {:>14.8e} {:>9.1e} {:>8.0e}  {}{}\n",
            row.index,
            row.kind,
            row.method,
            row.expected,
            row.value,
            row.relative_error,
            row.limit,
            row.device,
            if row.passes() { "" } else { "  TOO FAR OFF" }
        );
    }
    text
}

/// Fails if a row is beyond its limit, or if there is none: nothing checked is not verified.
fn judge(rows: &[Row]) -> Outcome {
    let Some(worst) = rows
        .iter()
        .max_by(|a, b| (a.relative_error / a.limit).total_cmp(&(b.relative_error / b.limit)))
    else {
        return Err(Failure::Verification(
            "no ray of a known kind: nothing was checked".to_owned(),
        ));
    };
    let failed = rows.iter().filter(|row| !row.passes()).count();
    let summary = format!(
        "{} of {} values within their limits; the worst is ray {} ({}, {}): {:.1e} of {:.0e} allowed",
        rows.len() - failed,
        rows.len(),
        worst.index,
        worst.kind,
        worst.method,
        worst.relative_error,
        worst.limit
    );
    if failed > 0 {
        return Err(Failure::Verification(summary));
    }
    note(&summary);
    Ok(())
}
