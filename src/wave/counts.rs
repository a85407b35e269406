//! What the wave's kernels count while they work.

use super::tiles;
use crate::opencl::{Counted, Counters};

/// Tiles: integrals, pairs of a ray and a source.
pub(super) const INTEGRALS: usize = 0;
/// Method exact, if the kernels are built to count them: nodes of quadratures.
pub(super) const NODES: usize = 1;
/// Tiles that a pass left open; a number for each pass.
const OPEN_TILES: usize = NODES + 1;

const LEN: usize = OPEN_TILES + tiles::MOST_PASSES;

/// All of them, on the device and on their way back.
pub(super) type Counts = Counters<LEN>;
pub(super) type CountedNumbers = Counted<LEN>;

/// Returns the numbers' places, for the kernels' compiler.
pub(super) fn definitions() -> String {
    format!(
        " -D COUNT_INTEGRALS={INTEGRALS} -D COUNT_NODES_TAKEN={NODES} -D COUNT_OPEN_TILES={OPEN_TILES}"
    )
}
