//! Plots of how one thing grows with another, both logarithmic.

use plotters::prelude::*;

/// What is plotted: a line with a mark at each place.
pub struct Line {
    pub label: String,
    pub color: RGBAColor,
    pub points: Vec<(f64, f64)>,
}

/// Returns with which power of the first the second grows, by least squares of the logarithms.
pub fn power(pairs: &[(f64, f64)]) -> f64 {
    let logs = || pairs.iter().map(|(x, y)| (x.ln(), y.ln()));
    let count = pairs.len() as f64;
    let (x, y) = logs().fold((0.0, 0.0), |sum, (x, y)| {
        (sum.0 + x / count, sum.1 + y / count)
    });
    let (mut above, mut below) = (0.0, 0.0);
    for (px, py) in logs() {
        above += (px - x) * (py - y);
        below += (px - x) * (px - x);
    }
    above / below
}

/// Writes a plot as SVG.
pub fn plot(path: &str, x_name: &str, y_name: &str, lines: &[Line]) {
    let area = SVGBackend::new(path, (720, 440)).into_drawing_area();
    area.fill(&WHITE).unwrap();
    let points = || lines.iter().flat_map(|line| &line.points);
    let range = |of: fn(&(f64, f64)) -> f64| {
        points()
            .map(of)
            .fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
                (low.min(value), high.max(value))
            })
    };
    let ((least_x, most_x), (least_y, most_y)) = (range(|it| it.0), range(|it| it.1));
    let mut chart = ChartBuilder::on(&area)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d(
            (least_x..most_x * 1.05).log_scale(),
            (least_y / 1.5..most_y * 1.5).log_scale(),
        )
        .unwrap();
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc(x_name)
        .y_desc(y_name)
        .x_label_formatter(&|x| format!("{x}"))
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .draw()
        .unwrap();
    for line in lines {
        let color = line.color;
        let drawn = LineSeries::new(line.points.iter().copied(), color.stroke_width(2));
        chart
            .draw_series(drawn.point_size(3))
            .unwrap()
            .label(&line.label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(3)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.3))
        .draw()
        .unwrap();
    area.present().unwrap();
}
