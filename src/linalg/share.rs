//! Rows of a block's columns, shared out among threads without allocating anything.

/// Calls `work(first row, those rows of every column)` for parts of at most `grain` rows, on any number of threads.
pub fn share<const C: usize>(
    mut columns: [&mut [f64]; C],
    first: usize,
    grain: usize,
    work: &(impl Fn(usize, [&mut [f64]; C]) + Sync),
) {
    let n = columns[0].len();
    if n <= grain {
        return work(first, columns);
    }
    let middle = (n / 2).next_multiple_of(grain);
    let upper = std::array::from_fn(|c| columns[c].split_off_mut(..middle).unwrap_or_default());
    rayon::join(|| share(upper, first, grain, work), || share(columns, first + middle, grain, work));
}
