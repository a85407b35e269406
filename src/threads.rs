//! Work on all cores where the feature `threads` is on, else on the caller's thread.

#[cfg(feature = "threads")]
use rayon::prelude::*;

/// Calls `work` with the number of each chunk of `len` values, and the chunk; what is left over at the end is no chunk.
pub(crate) fn for_each_chunk<T: Send>(
    values: &mut [T],
    len: usize,
    work: impl Fn(usize, &mut [T]) + Send + Sync,
) {
    #[cfg(feature = "threads")]
    let chunks = values.par_chunks_exact_mut(len);
    #[cfg(not(feature = "threads"))]
    let chunks = values.chunks_exact_mut(len);
    chunks
        .enumerate()
        .for_each(|(index, chunk)| work(index, chunk));
}

/// Finds a number for which `work` finds something; any if there are several.
pub(crate) fn find_any<T: Send>(
    numbers: &[usize],
    find: impl Fn(usize) -> Option<T> + Send + Sync,
) -> Option<T> {
    #[cfg(feature = "threads")]
    return numbers.par_iter().find_map_any(|number| find(*number));
    #[cfg(not(feature = "threads"))]
    return numbers.iter().find_map(|number| find(*number));
}

/// Returns how many threads work.
pub(crate) fn count() -> usize {
    #[cfg(feature = "threads")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "threads"))]
    return 1;
}
