//! What each step of the pyramid is, and how its work is shared out.

use crate::image::{Axis, Bloom, ImageSize};
use crate::opencl::{DeviceForm, device_struct};

device_struct! {
    /// A step from a fine size to one half as wide and high, and back.
    BloomStep [56] {
        fine_width: u32 = 0,
        fine_height: u32 = 4,
        width: u32 = 8,
        height: u32 = 12,
        fine_at: u32 = 16,
        at: u32 = 20,
        across: u32 = 24,
        down: u32 = 28,
        inner_begin: u32 = 32,
        inner_end: u32 = 36,
        pieces: u32 = 40,
        span: u32 = 44,
        fine_share: f32 = 48,
        share: f32 = 52,
    }
}

/// The weights away from all borders, times 16.
const MIDDLE: [f32; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];

/// Columns that a work-item of a CPU takes: few enough that a picture of few rows keeps all cores busy. From 64 to 1920
/// they take as long on PoCL 3.1.
const SPAN: u32 = 256;

/// Levels of no more pixels are left to one group: another launch would take longer.
const FEW: u32 = 1 << 13;

/// All steps of a picture, from the finest on.
#[derive(Debug, Default)]
pub(super) struct Steps {
    pub list: Vec<BloomStep>,
    /// Of rows and columns of all steps.
    pub weights: Vec<f32>,
    /// How many pixels all levels have.
    pub pixels: usize,
    /// The first step that one group takes, with all that follow.
    pub first_small: u32,
}

impl Steps {
    pub(super) fn new(size: ImageSize, bloom: &Bloom, form: DeviceForm) -> Self {
        let shares = bloom.shares(size);
        let mut steps = Self::default();
        let mut across = Axis::of_picture(size.width);
        let mut down = Axis::of_picture(size.height);
        let (mut fine_width, mut fine_height, mut fine_at, mut at) =
            (size.width, size.height, 0, 0);
        for number in 0..shares.len() {
            let (width, height) = (across.weights.len() as u32, down.weights.len() as u32);
            let inner = inner(&across);
            let span = match form {
                DeviceForm::Cpu => SPAN,
                DeviceForm::Gpu => 1,
            };
            let is_last = number + 1 == shares.len();
            let weights = steps.weights.len() as u32;
            steps.list.push(BloomStep {
                fine_width,
                fine_height,
                width,
                height,
                fine_at,
                at,
                across: weights,
                down: weights + 5 * width,
                inner_begin: inner.0,
                inner_end: inner.1,
                pieces: width.div_ceil(span),
                span,
                fine_share: if number == 0 { 0.0 } else { shares[number - 1] },
                share: if is_last { shares[number] } else { 1.0 },
            });
            steps.weights.extend(across.weights.as_flattened());
            steps.weights.extend(down.weights.as_flattened());
            (fine_width, fine_height) = (width, height);
            (fine_at, at) = (at, at + width * height);
            (across, down) = (across.next(), down.next());
        }
        steps.pixels = at as usize;
        let is_small = |step: &BloomStep| step.fine_width * step.fine_height <= FEW;
        let small = steps.list.iter().skip(1).position(is_small);
        steps.first_small = small.map_or(steps.list.len(), |number| number + 1) as u32;
        steps
    }
}

/// What a launch does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    HalvePicture,
    HalveLevel,
    SmallLevels,
    DoubleLevel,
    Finish,
}

/// A launch: what it does, from which step on.
#[derive(Debug)]
pub(super) struct Launch {
    pub stage: Stage,
    pub step: u32,
    /// Work-items; `None`: a group.
    pub items: Option<usize>,
}

impl Launch {
    /// Returns how many work-items a group should have.
    pub(super) fn group(&self, form: DeviceForm) -> usize {
        match (form, self.stage) {
            (DeviceForm::Cpu, _) => 1,
            (DeviceForm::Gpu, Stage::SmallLevels) => 256,
            (DeviceForm::Gpu, _) => 64,
        }
    }
}

impl Steps {
    /// Returns the launches of a picture, in order: down to the coarsest level, and up again.
    pub(super) fn launches(&self) -> impl Iterator<Item = Launch> {
        let of = |stage: Stage, step: u32| {
            let BloomStep { pieces, height, .. } = self.list[step as usize];
            Launch {
                stage,
                step,
                items: (stage != Stage::SmallLevels).then_some((pieces * height) as usize),
            }
        };
        let small = self.first_small;
        let large = 1..small;
        let has_small = (small as usize) < self.list.len();
        std::iter::once(of(Stage::HalvePicture, 0))
            .chain(large.clone().map(move |step| of(Stage::HalveLevel, step)))
            .chain(has_small.then(|| of(Stage::SmallLevels, small)))
            .chain(large.rev().map(move |step| of(Stage::DoubleLevel, step)))
            .chain(std::iter::once(of(Stage::Finish, 0)))
    }
}

/// Returns the first of the columns that have the weights of the middle, and the one after the last.
fn inner(axis: &Axis) -> (u32, u32) {
    let is_inner = |weights: &&[f32; 5]| weights.map(|weight| 16.0 * weight) == MIDDLE;
    let begin = axis.weights.iter().take_while(|it| !is_inner(it)).count();
    let inner = axis.weights[begin..].iter().take_while(is_inner).count();
    (begin as u32, (begin + inner) as u32)
}
