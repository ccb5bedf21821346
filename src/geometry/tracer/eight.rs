//! Eight f32 at a time: on AVX2 where the machine has it, by plain arithmetic elsewhere.

use pulp::{Scalar256b, Simd, f32x8, u32x8};

/// Instructions on eight f32, and the eight sign bits of a result as one number.
pub(super) trait Eight: Simd<f32s = f32x8, u32s = u32x8> {
    /// Bit k is set if lane k is below zero, or is −0.
    fn signs(self, lanes: f32x8) -> u32;

    /// Bit k is set if number k is `value`.
    fn equals(self, numbers: u32x8, value: u32) -> u32;

    /// a with the sign turned where that of `by` is set.
    #[inline(always)]
    fn turn(self, a: f32x8, by: f32x8) -> f32x8 {
        let sign = self.and_u32s(self.transmute_u32s_f32s(by), self.splat_u32s(1 << 31));
        self.transmute_f32s_u32s(self.xor_u32s(self.transmute_u32s_f32s(a), sign))
    }

    /// A vector, eight times.
    #[inline(always)]
    fn splat3(self, [x, y, z]: [f32; 3]) -> [f32x8; 3] {
        [self.splat_f32s(x), self.splat_f32s(y), self.splat_f32s(z)]
    }

    /// n · v + offset.
    #[inline(always)]
    fn dot_add(self, n: &[f32x8; 3], v: &[f32x8; 3], offset: f32x8) -> f32x8 {
        self.mul_add_e_f32s(n[2], v[2], self.mul_add_e_f32s(n[1], v[1], self.mul_add_e_f32s(n[0], v[0], offset)))
    }

    /// n · v.
    #[inline(always)]
    fn dot(self, n: &[f32x8; 3], v: &[f32x8; 3]) -> f32x8 {
        self.mul_add_e_f32s(n[2], v[2], self.mul_add_e_f32s(n[1], v[1], self.mul_f32s(n[0], v[0])))
    }
}

impl Eight for Scalar256b {
    #[inline(always)]
    fn signs(self, lanes: f32x8) -> u32 {
        let lanes: [f32; 8] = pulp::cast(lanes);
        lanes.iter().enumerate().fold(0, |bits, (k, lane)| bits | (lane.to_bits() >> 31) << k)
    }

    #[inline(always)]
    fn equals(self, numbers: u32x8, value: u32) -> u32 {
        let numbers: [u32; 8] = pulp::cast(numbers);
        numbers.iter().enumerate().fold(0, |bits, (k, number)| bits | u32::from(*number == value) << k)
    }
}

#[cfg(target_arch = "x86_64")]
impl Eight for pulp::x86::V3 {
    #[inline(always)]
    fn signs(self, lanes: f32x8) -> u32 {
        self.avx._mm256_movemask_ps(pulp::cast(lanes)) as u32
    }

    #[inline(always)]
    fn equals(self, numbers: u32x8, value: u32) -> u32 {
        let same = self.avx2._mm256_cmpeq_epi32(pulp::cast(numbers), pulp::cast(self.splat_u32s(value)));
        self.signs(pulp::cast(same))
    }
}

/// Something computed alike on any instructions.
pub(super) trait Kernel {
    type Output;

    fn run(self, simd: impl Eight) -> Self::Output;
}

/// Runs the kernel on the best instructions of this machine.
#[inline]
pub(super) fn run<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        return simd.vectorize(On { simd, kernel });
    }
    kernel.run(Scalar256b)
}

#[cfg(target_arch = "x86_64")]
struct On<S, K> {
    simd: S,
    kernel: K,
}

#[cfg(target_arch = "x86_64")]
impl<S: Eight, K: Kernel> pulp::NullaryFnOnce for On<S, K> {
    type Output = K::Output;

    #[inline(always)]
    fn call(self) -> K::Output {
        self.kernel.run(self.simd)
    }
}
