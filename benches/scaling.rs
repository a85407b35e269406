//! How a frame's time and integrals grow with the image and with the number of sources, by tiles and by pixels, method
//! exact at a tolerance of 1e-3.
//!
//! `cargo bench --bench scaling` prints tables and fitted exponents; `cargo bench --bench scaling --
//! benches/results/NAME` also writes NAME.md and the plots NAME-width.svg and NAME-sources.svg.
#![allow(clippy::unwrap_used)] // a bench that fails stops

mod common;
#[path = "common/plot.rs"]
mod plot;

use std::fmt::Write;
use std::time::Duration;

use energywave::image::ImageSize;
use energywave::papers::{Table, exact_cost, measure};
use energywave::scene::{Curve, Method, Profile, Sampling, Sphere};
use energywave::{Device, Renderer, Scene};
use glam::DVec3;
use plot::Line;
use plotters::style::{Color, RGBColor};

const TIME: Duration = Duration::from_secs(1);
const WIDTHS: [u32; 6] = [256, 512, 1024, 2048, 4096, 8192];
const SPHERES: [u32; 7] = [1, 4, 16, 64, 256, 1024, 4096];
const CURVES: [u32; 5] = [1, 4, 16, 64, 256];

/// One scene at growing sizes, by one sampling.
struct Series {
    name: &'static str,
    sampling: Sampling,
    points: Vec<Point>,
}

struct Point {
    /// Width, or number of sources.
    size: u32,
    seconds: f64,
    integrals: f64,
}

impl Series {
    /// Exponents of time and of integrals over the sizes from `from` on, by least squares of the logarithms.
    fn exponents(&self, from: u32) -> (f64, f64) {
        let points: Vec<&Point> = self.points.iter().filter(|p| p.size >= from).collect();
        let fit = |value: fn(&Point) -> f64| {
            let pairs: Vec<_> = points
                .iter()
                .map(|p| (f64::from(p.size), value(p)))
                .collect();
            plot::power(&pairs)
        };
        (fit(|p| p.seconds), fit(|p| p.integrals))
    }

    fn label(&self) -> String {
        let sampling = match self.sampling {
            Sampling::Tiles => "tiles",
            _ => "pixels",
        };
        format!("{}, {sampling}", self.name)
    }
}

/// The tables' camera and decay.
fn view() -> Scene {
    let mut scene = Table::Torus.scene(512, 200);
    scene.tori.clear();
    scene.integration.method = Method::default();
    scene
}

fn one_torus(width: u32) -> Scene {
    Scene {
        tori: Table::Torus.scene(1, 2).tori,
        ..wide(width)
    }
}

fn one_curve(width: u32) -> Scene {
    Scene {
        curves: Table::Bezier.scene(1, 2).curves,
        ..wide(width)
    }
}

fn wide(width: u32) -> Scene {
    let mut scene = view();
    scene.image = ImageSize {
        width,
        height: width * 9 / 16,
    };
    scene
}

fn points(count: u32) -> Vec<DVec3> {
    let mut random = fastrand::Rng::with_seed(1);
    let mut point = || DVec3::from([0; 3].map(|_| 2.0 * random.f64() - 1.0));
    (0..count).map(|_| point()).collect()
}

fn spheres(count: u32) -> Scene {
    let mut scene = view();
    scene.spheres = points(count)
        .into_iter()
        .map(|center| Sphere {
            center,
            profile: Profile::Inverse,
            coefficient: 1.0,
            ..Sphere::default()
        })
        .collect();
    scene
}

fn curves(count: u32) -> Scene {
    let mut scene = view();
    let points = points(3 * count);
    scene.curves = points
        .chunks(3)
        .map(|p| Curve {
            profile: Profile::Inverse,
            coefficient: 1.0,
            ..Curve::new([p[0], p[1], p[2]])
        })
        .collect();
    scene
}

type Setup = (&'static str, fn(u32) -> Scene, &'static [u32]);

/// Measures scenes at every size, tiles and pixels in turn.
fn series(device: &Device, renderer: &mut Renderer, setups: &[Setup]) -> Vec<Series> {
    let mut all = Vec::new();
    for (name, scene, sizes) in setups {
        let mut both = [Sampling::Tiles, Sampling::Pixels].map(|sampling| Series {
            name,
            sampling,
            points: Vec::new(),
        });
        for size in *sizes {
            for series in &mut both {
                let mut scene = scene(*size);
                scene.integration.method = Method::Exact {
                    tolerance: 1e-3,
                    sampling: series.sampling,
                };
                let integrals = match series.sampling {
                    Sampling::Tiles => exact_cost(device, &scene).unwrap().integrals,
                    _ => (scene.image.pixels() * scene.source_count()) as u64,
                };
                series.points.push(Point {
                    size: *size,
                    seconds: 1.0 / measure(renderer, &scene, TIME).unwrap().fps,
                    integrals: integrals as f64,
                });
                eprintln!("{name}, {size}");
            }
        }
        all.extend(both);
    }
    all
}

fn table(text: &mut String, heading: &str, series: &[Series], fit_from: u32) {
    let _ = writeln!(text, "\n{heading}\n");
    for pair in series.chunks(2) {
        let [tiles, pixels] = pair else { continue };
        let _ = writeln!(
            text,
            "{}\n\n| | tiles, FPS | pixels, FPS | tiles / pixels | tiles, integrals | pixels, integrals |\n\
             |---|---|---|---|---|---|",
            tiles.name
        );
        for (t, p) in tiles.points.iter().zip(&pixels.points) {
            let _ = writeln!(
                text,
                "| {} | {:.1} | {:.2} | {:.1} | {} | {} |",
                t.size,
                1.0 / t.seconds,
                1.0 / p.seconds,
                p.seconds / t.seconds,
                t.integrals,
                p.integrals
            );
        }
        let (t, p) = (tiles.exponents(fit_from), pixels.exponents(fit_from));
        let _ = writeln!(
            text,
            "\nFrom {fit_from} on time grows with the power {:.2} by tiles, {:.2} by pixels; integrals {:.2} and \
             {:.2}.\n",
            t.0, p.0, t.1, p.1
        );
    }
}

/// Seconds a frame against the size, both logarithmic.
fn plot(path: &str, x_name: &str, series: &[Series]) {
    let colors = [RGBColor(20, 70, 200), RGBColor(200, 80, 20)];
    let line = |(index, one): (usize, &Series)| {
        let base = colors[index / 2 % 2];
        Line {
            label: one.label(),
            color: match one.sampling {
                Sampling::Tiles => base.to_rgba(),
                _ => base.mix(0.4),
            },
            points: (one.points.iter())
                .map(|p| (f64::from(p.size), p.seconds))
                .collect(),
        }
    };
    let lines: Vec<Line> = series.iter().enumerate().map(line).collect();
    plot::plot(path, x_name, "seconds a frame", &lines);
}

#[allow(unsafe_code)] // one call that must come before everything else
fn main() {
    // SAFETY: nothing has started a thread yet.
    unsafe { energywave::keep_pocl_threads_apart() };
    let (device, mut renderer) = common::device();
    let by_width = series(
        &device,
        &mut renderer,
        &[
            ("a torus", one_torus, &WIDTHS),
            ("a curve", one_curve, &WIDTHS),
        ],
    );
    let by_sources = series(
        &device,
        &mut renderer,
        &[("spheres", spheres, &SPHERES), ("curves", curves, &CURVES)],
    );
    let mut text = common::header(&device, "cargo bench --bench scaling");
    let heading = "By width, 16:9, the wave of the paper's tables:";
    table(&mut text, heading, &by_width, 512);
    let heading = "By number of sources in a cube of side 2, 512x512:";
    table(&mut text, heading, &by_sources, 16);
    println!("{text}");
    if let Some(stem) = std::env::args().skip(1).find(|a| !a.starts_with("--")) {
        std::fs::write(format!("{stem}.md"), &text).unwrap();
        plot(&format!("{stem}-width.svg"), "width, pixels", &by_width);
        plot(&format!("{stem}-sources.svg"), "sources", &by_sources);
    }
}
