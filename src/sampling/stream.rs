//! Random streams that are keyed, not advanced: any draw can be had again without the draws before it.

use super::philox;
use rand_philox::{philox4x32_10, splitmix64};

/// 2⁶⁴ over the golden ratio, made odd: keeps a zero seed away from the fixed point of `splitmix64`.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A 64-bit seed for one of many tasks: for one `seed`, different keys give different results.
pub fn mix_seed(seed: u64, key: u64) -> u64 {
    splitmix64(splitmix64(seed.wrapping_add(GOLDEN)).wrapping_add(GOLDEN).wrapping_add(key))
}

/// The streams of one experiment and one purpose: the same seed used for two purposes gives unrelated numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Streams {
    key: [u32; 2],
}

impl Streams {
    /// `purpose` says who draws, e.g. `"path tracer"`; any two different texts are independent.
    pub fn new(seed: u64, purpose: &str) -> Self {
        let key =
            purpose.bytes().fold(mix_seed(seed, purpose.len() as u64), |key, byte| mix_seed(key, u64::from(byte)));
        Self { key: [key as u32, (key >> 32) as u32] }
    }

    /// The stream of sample number `sample` of start number `start` (a bundle, a pixel, a pair).
    ///
    /// Cost: nothing until the first draw.
    #[inline]
    pub fn stream(&self, start: u32, sample: u64) -> Stream {
        Stream { key: self.key, start, sample, n_blocks: 0, spare: None }
    }

    /// [`Stream::uniform3`] of many streams of one start at once: what each would draw from its block of this number.
    ///
    /// # Panics
    /// If there is not room for each.
    #[inline(always)]
    pub fn uniform3_many(&self, start: u32, samples: &[u64], block: u32, [a, b, c]: [&mut [f64]; 3]) {
        let n = samples.len();
        let (a, b, c) = (&mut a[..n], &mut b[..n], &mut c[..n]);
        for (k, sample) in samples.iter().enumerate() {
            let counter = [block, *sample as u32, (*sample >> 32) as u32, start];
            [a[k], b[k], c[k]] = three(halves(philox::block(counter, self.key)));
        }
    }
}

/// One stream of uniform numbers: Philox4x32-10 (Salmon et al. 2011), a function of (seed, purpose, start, sample) and of how many
/// numbers were drawn, so results do not depend on threads or on order.
///
/// Holds 2³² blocks of two numbers each; a longer one would begin again.
#[derive(Clone, Debug)]
pub struct Stream {
    key: [u32; 2],
    start: u32,
    sample: u64,
    /// Blocks drawn.
    n_blocks: u32,
    /// The second half of the last block, if it is to be used.
    spare: Option<u64>,
}

impl Stream {
    /// The stream of (start, sample) without a purpose. For many streams of one seed, [`Streams`] mixes the seed once.
    pub fn new(seed: u64, start: u32, sample: u64) -> Self {
        Streams::new(seed, "").stream(start, sample)
    }

    /// 64 random bits.
    #[inline]
    pub fn bits(&mut self) -> u64 {
        if let Some(bits) = self.spare.take() {
            return bits;
        }
        let [first, second] = self.block();
        self.spare = Some(second);
        first
    }

    /// Uniform in [0, 1), a multiple of 2⁻⁵³.
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        unit_interval(self.bits())
    }

    /// Two numbers uniform in [0, 1): one block of the generator, where an even number was drawn before.
    #[inline]
    pub fn uniform2(&mut self) -> [f64; 2] {
        if self.spare.is_some() {
            return [self.uniform(), self.uniform()];
        }
        self.block().map(unit_interval)
    }

    /// Three numbers uniform in [0, 1), multiples of 2⁻⁴²: one block of the generator, for what is drawn often and needs no more digits. Half a
    /// block that [`Stream::uniform`] may have left over is dropped.
    #[inline]
    pub fn uniform3(&mut self) -> [f64; 3] {
        self.spare = None;
        three(self.block())
    }

    /// Where the stream stands: what it is one of, its start and sample, and how many blocks it has drawn.
    pub fn address(&self) -> (Streams, u32, u64, u32) {
        (Streams { key: self.key }, self.start, self.sample, self.n_blocks)
    }

    /// Leaves out so many blocks, and half a block that may have been left over.
    pub fn skip(&mut self, n_blocks: u32) {
        self.n_blocks = self.n_blocks.wrapping_add(n_blocks);
        self.spare = None;
    }

    /// The next 128 bits.
    #[inline]
    fn block(&mut self) -> [u64; 2] {
        let counter = [self.n_blocks, self.sample as u32, (self.sample >> 32) as u32, self.start];
        self.n_blocks = self.n_blocks.wrapping_add(1);
        halves(philox4x32_10(counter, self.key))
    }
}

#[inline(always)]
fn halves(words: [u32; 4]) -> [u64; 2] {
    let [a, b, c, d] = words.map(u64::from);
    [a | b << 32, c | d << 32]
}

/// 128 bits as three numbers of 42.
#[inline(always)]
fn three([first, second]: [u64; 2]) -> [f64; 3] {
    // Bits below 2⁵² in the fraction of a number of 2⁵²: converted without an instruction that only some machines have.
    const EXPONENT: u64 = 0x433 << 52;
    const SCALE: f64 = 1.0 / (1u64 << 42) as f64;
    let third = (first & 0x3f_ffff) << 20 | second & 0xf_ffff;
    [first >> 22, second >> 22, third].map(|bits| (f64::from_bits(bits | EXPONENT) - (1u64 << 52) as f64) * SCALE)
}

/// The upper 53 bits as a number in [0, 1).
#[inline]
pub(super) fn unit_interval(bits: u64) -> f64 {
    const SCALE: f64 = 1.0 / (1u64 << 53) as f64;
    (bits >> 11) as f64 * SCALE
}
