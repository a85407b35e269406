//! The paper's Tables 2 and 3: ours, the paper's, and the plain transcription `benches/plain.cl`, in one run.
//!
//! `cargo bench --bench tables` prints them; `cargo bench --bench tables -- benches/results/NAME` also writes NAME.md,
//! a record with machine, device, driver and command, and NAME.svg, frames a second against evaluations a frame.
#![allow(clippy::unwrap_used, clippy::panic)] // a bench that fails stops
#![allow(unsafe_code)] // one call must come before everything else, and a kernel of its own is run

mod common;

use std::fmt::Write;
use std::time::{Duration, Instant};

use energywave::image::compare;
use energywave::internals::pack::{self, layout};
use energywave::internals::{
    self, Compute, DeviceBuffer, FilmPart, OpenClDevice, Program, discover,
};
use energywave::papers::{DIVISIONS, FRAMES_PER_TURN, RESOLUTIONS, Table, measure, turned};
use energywave::scene::Method;
use energywave::{Device, RadianceImage, RendererOptions, Scene};
use glam::DVec3;
use plotters::prelude::*;

const TIME: Duration = Duration::from_secs(1);

struct Cell {
    table: Table,
    resolution: u32,
    divisions: u32,
    ours: f64,
    plain: f64,
    paper: f64,
}

impl Cell {
    fn evaluations(&self) -> f64 {
        f64::from(self.resolution * self.resolution) * f64::from(self.divisions + 1)
    }
}

fn main() {
    // SAFETY: nothing has started a thread yet.
    unsafe { energywave::keep_pocl_threads_apart() };
    let (device, mut renderer) = common::device();
    let opencl: OpenClDevice = discover()
        .devices
        .into_iter()
        .find(|d| d.name == device.name)
        .unwrap();
    let mut cells = Vec::new();
    for table in [Table::Torus, Table::Bezier] {
        let plain = Plain::new(&opencl, table);
        for (row, resolution) in RESOLUTIONS.into_iter().enumerate() {
            for (column, divisions) in DIVISIONS.into_iter().enumerate() {
                let scene = table.scene(resolution, divisions);
                cells.push(Cell {
                    table,
                    resolution,
                    divisions,
                    ours: measure(&mut renderer, &scene, TIME).unwrap().fps,
                    plain: plain.fps(&scene, &renderer.render(&scene).unwrap()),
                    paper: table.paper_fps()[row][column],
                });
            }
        }
    }
    let text = record(&device, &cells);
    println!("{text}");
    if let Some(stem) = std::env::args().skip(1).find(|a| !a.starts_with("--")) {
        std::fs::write(format!("{stem}.md"), &text).unwrap();
        plot(&format!("{stem}.svg"), &cells);
    }
}

/// The plain kernel and its buffers.
struct Plain {
    compute: Compute,
    program: Program,
}

impl Plain {
    fn new(device: &OpenClDevice, table: Table) -> Self {
        let compute = Compute::new(device).unwrap();
        let mut options = RendererOptions::default();
        options.lanes = Some(1);
        let kind = format!("-DIS_TORUS={}", u8::from(table == Table::Torus));
        // SAFETY: the kernel of plain.cl stays within its image either way.
        let options = unsafe { internals::with_compiler_options(&options, &kind) };
        let (name, text) = ("benches/plain.cl", include_str!("plain.cl"));
        let program = internals::build_text(&compute, name, text, &[], &options).unwrap();
        Self { compute, program }
    }

    /// Frames a second by the median time of whole frames, read-back included, as [`measure`] does. The first frame
    /// must show what `ours` shows.
    fn fps(&self, scene: &Scene, ours: &RadianceImage) -> f64 {
        let pixels = scene.image.pixels();
        let mut image = vec![[0.0_f32; 4]; pixels];
        let output = DeviceBuffer::new(&self.compute, "the image", pixels).unwrap();
        let mut source = DeviceBuffer::new(&self.compute, "the source", 12).unwrap();
        let part = FilmPart {
            count: pixels as u32,
            ..bytemuck::Zeroable::zeroed()
        };
        let integrand = layout::Integrand {
            node_count: divisions_of(scene) + 1,
            ..bytemuck::Zeroable::zeroed()
        };
        let mut render = |frame: u32, image: &mut [[f32; 4]]| {
            let scene = turned(scene, frame);
            let plane = scene.view_plane();
            let view = pack::view(&plane, &scene);
            source
                .write(&self.compute, &parameters(&scene, plane.eye))
                .unwrap();
            let (compute, program) = (&self.compute, &self.program);
            let arguments: [(&str, &dyn internals::Argument); 5] = [
                ("view", &view),
                ("part", &part),
                ("integrand", &integrand),
                ("source", &source),
                ("image", &output),
            ];
            // SAFETY: image and source have the sizes that plain.cl expects.
            unsafe { internals::run(compute, program, "plain", &arguments, pixels, 64) }.unwrap();
            output.read(&self.compute, image).unwrap();
        };
        render(0, &mut image);
        let mut first = RadianceImage::new(scene.image).unwrap();
        first
            .as_mut_slice()
            .copy_from_slice(bytemuck::cast_slice(&image));
        let difference = compare(&first, ours).unwrap();
        assert!(
            difference.p999 < 1e-3,
            "plain.cl draws something else: {difference:?}"
        );
        let mut times = Vec::new();
        let begun = Instant::now();
        while begun.elapsed() < TIME || times.len() < 3 {
            let frame_begun = Instant::now();
            render(times.len() as u32 % FRAMES_PER_TURN, &mut image);
            times.push(frame_begun.elapsed());
        }
        times.sort();
        1.0 / times[times.len() / 2].as_secs_f64()
    }
}

fn divisions_of(scene: &Scene) -> u32 {
    match scene.integration.method {
        Method::Simpson { divisions } => divisions,
        _ => panic!("the tables are for Simpson's rule"),
    }
}

/// What `benches/plain.cl` reads: the source seen from the eye, coefficient, alpha, beta.
fn parameters(scene: &Scene, eye: DVec3) -> Vec<f32> {
    let decay = scene.decay.unwrap();
    let mut values: Vec<f64> = Vec::new();
    for torus in &scene.tori {
        values.extend((torus.center - eye).to_array());
        values.extend([torus.major_radius, torus.coefficient]);
    }
    for curve in &scene.curves {
        for point in curve.control_points {
            values.extend((point - eye).to_array());
        }
        values.push(curve.coefficient);
    }
    values.extend([decay.alpha, decay.beta]);
    values.into_iter().map(|value| value as f32).collect()
}

fn record(device: &Device, cells: &[Cell]) -> String {
    let mut text = common::header(device, "cargo bench --bench tables");
    text.push_str("* the paper's device: AMD FirePro D500\n\n");
    for table in [Table::Torus, Table::Bezier] {
        let _ = writeln!(
            text,
            "Table {}, {}\n\n| image | divisions | ours | paper | ours / paper | plain.cl | ours / plain |\n\
             |---|---|---|---|---|---|---|",
            table.number(),
            table.field()
        );
        for cell in cells.iter().filter(|cell| cell.table == table) {
            let _ = writeln!(
                text,
                "| {0}x{0} | {1} | {2:.1} | {3:.2} | {4:.1} | {5:.2} | {6:.1} |",
                cell.resolution,
                cell.divisions,
                cell.ours,
                cell.paper,
                cell.ours / cell.paper,
                cell.plain,
                cell.ours / cell.plain
            );
        }
        text.push('\n');
    }
    text
}

/// Frames a second against evaluations a frame, both logarithmic.
fn plot(path: &str, cells: &[Cell]) {
    let area = SVGBackend::new(path, (720, 440)).into_drawing_area();
    area.fill(&WHITE).unwrap();
    let mut chart = ChartBuilder::on(&area)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d((1e6..1e8_f64).log_scale(), (0.01..1e4_f64).log_scale())
        .unwrap();
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc("field evaluations a frame")
        .y_desc("frames a second")
        .x_label_formatter(&|x| format!("{x:.0e}"))
        .y_label_formatter(&|y| format!("{y}"))
        .draw()
        .unwrap();
    type Series = (&'static str, fn(&Cell) -> f64, [RGBColor; 2]);
    let series: [Series; 3] = [
        (
            "ours",
            |cell| cell.ours,
            [RGBColor(20, 70, 200), RGBColor(90, 150, 255)],
        ),
        (
            "paper",
            |cell| cell.paper,
            [RGBColor(180, 60, 20), RGBColor(240, 150, 80)],
        ),
        (
            "plain.cl",
            |cell| cell.plain,
            [RGBColor(90, 90, 90), RGBColor(170, 170, 170)],
        ),
    ];
    for (name, value, colors) in series {
        for (table, color) in [Table::Torus, Table::Bezier].into_iter().zip(colors) {
            let mut points: Vec<(f64, f64)> = cells
                .iter()
                .filter(|cell| cell.table == table)
                .map(|cell| (cell.evaluations(), value(cell)))
                .collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let line = LineSeries::new(points, color.stroke_width(2)).point_size(3);
            chart
                .draw_series(line)
                .unwrap()
                .label(format!("{name}, {}", table.field()))
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 18, y)], color.stroke_width(3))
                });
        }
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()
        .unwrap();
    area.present().unwrap();
}
