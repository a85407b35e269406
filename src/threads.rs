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

/// So many values a thread takes at once from [`map`], [`greatest`], [`sum`] and [`find_first`], whose work is small.
#[cfg(feature = "threads")]
const PART: usize = 4096;

/// Returns what `make` makes of each value.
pub(crate) fn map<T: Sync, U: Send>(values: &[T], make: impl Fn(&T) -> U + Send + Sync) -> Vec<U> {
    #[cfg(feature = "threads")]
    return values.par_iter().with_min_len(PART).map(make).collect();
    #[cfg(not(feature = "threads"))]
    return values.iter().map(make).collect();
}

/// Returns the greatest size of a value, 0 where there is none.
pub(crate) fn greatest<T: Sync>(values: &[T], size: impl Fn(&T) -> f64 + Send + Sync) -> f64 {
    #[cfg(feature = "threads")]
    let sizes = values.par_iter().with_min_len(PART).map(size);
    #[cfg(feature = "threads")]
    return sizes.reduce(|| 0.0, f64::max);
    #[cfg(not(feature = "threads"))]
    return values.iter().map(size).fold(0.0, f64::max);
}

/// Returns the sum of a whole number of each value: below 2^53 it does not depend on their order.
pub(crate) fn sum<T: Sync>(values: &[T], number: impl Fn(&T) -> f64 + Send + Sync) -> f64 {
    #[cfg(feature = "threads")]
    return values.par_iter().with_min_len(PART).map(number).sum();
    #[cfg(not(feature = "threads"))]
    return values.iter().map(number).sum();
}

/// Calls `work` with the place of the first value of each chunk of `len` values, and the chunk; the last may be short.
pub(crate) fn for_each_part<T: Send>(
    values: &mut [T],
    len: usize,
    work: impl Fn(usize, &mut [T]) + Send + Sync,
) {
    #[cfg(feature = "threads")]
    let parts = values.par_chunks_mut(len);
    #[cfg(not(feature = "threads"))]
    let parts = values.chunks_mut(len);
    parts
        .enumerate()
        .for_each(|(index, part)| work(index * len, part));
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

/// Returns what `find` finds for the first value for which it finds something, given with its place.
pub(crate) fn find_first<T: Sync, U: Send>(
    values: &[T],
    find: impl Fn(usize, &T) -> Option<U> + Send + Sync,
) -> Option<U> {
    #[cfg(feature = "threads")]
    let places = values.par_iter().with_min_len(PART).enumerate();
    #[cfg(feature = "threads")]
    return places.find_map_first(|(place, value)| find(place, value));
    #[cfg(not(feature = "threads"))]
    return values
        .iter()
        .enumerate()
        .find_map(|(place, value)| find(place, value));
}

/// Returns how many threads work.
pub(crate) fn count() -> usize {
    #[cfg(feature = "threads")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "threads"))]
    return 1;
}
