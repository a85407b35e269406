//! States that are kept, so that no frame is far from one: the state at a frame is a function of the scene and the
//! frame alone, in whatever order frames are asked for.

use super::Contact;
use super::laws::Laws;
use super::state::State;
use super::step::Scratch;

/// So many states are kept at most, and so much memory is taken by them but for one.
const MOST_STATES: usize = 64;
const MOST_BYTES: usize = 128 << 20;

/// States at frames that are multiples of a spacing, from 0 on, and the one that was asked for last.
#[derive(Debug)]
pub(super) struct History {
    spacing: u32,
    kept: Vec<State>,
    now: State,
    scratch: Scratch,
}

impl History {
    pub(super) fn new(waves: usize) -> Self {
        Self {
            spacing: 1,
            kept: vec![State::new(waves)],
            now: State::new(waves),
            scratch: Scratch::default(),
        }
    }

    /// Returns the state at a frame.
    pub(super) fn at(&mut self, laws: &Laws, frame: u32) -> &State {
        self.go(laws, frame);
        &self.now
    }

    /// Goes to a frame from the nearest one before it.
    fn go(&mut self, laws: &Laws, frame: u32) {
        let nearest = (frame / self.spacing) as usize;
        let nearest = &self.kept[nearest.min(self.kept.len() - 1)];
        if self.now.frame > frame || self.now.frame < nearest.frame {
            self.now.clone_from(nearest);
        }
        self.walk(laws, frame, &mut |_| {});
    }

    /// Goes on to a later frame.
    fn walk(&mut self, laws: &Laws, frame: u32, see: &mut impl FnMut(Contact)) {
        while self.now.frame < frame {
            laws.step(&mut self.now, &mut self.scratch, see);
            self.keep();
        }
    }

    /// Goes from one frame to another, and shows all contacts on the way.
    pub(super) fn contacts(
        &mut self,
        laws: &Laws,
        first: u32,
        last: u32,
        see: &mut impl FnMut(Contact),
    ) {
        self.go(laws, first);
        self.walk(laws, last, see);
    }

    /// Keeps the state if it is the next to be kept; where there are too many, every second goes.
    fn keep(&mut self) {
        if self.now.frame as usize != self.kept.len() * self.spacing as usize {
            return;
        }
        self.kept.push(self.now.clone());
        let bytes = |kept: &[State]| kept.iter().map(State::bytes).sum::<usize>();
        while self.kept.len() > MOST_STATES || self.kept.len() > 2 && bytes(&self.kept) > MOST_BYTES
        {
            let mut index = 0;
            self.kept.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.spacing *= 2;
        }
    }
}
