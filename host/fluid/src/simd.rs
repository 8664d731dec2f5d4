//! One build, every machine: kernels are compiled for several vector widths and the
//! widest that the processor has is called at run time.
//!
//! A kernel that is generic over its [`Arithmetic`] multiplies and adds in one rounding where the
//! class can: AVX2 and AVX-512 do so in the same order and compute the same bits, the portable
//! class rounds twice. Kernels that are mere closures compute the same bits in all classes. No
//! sum is ever reordered.

use std::fmt;

/// How a kernel multiplies and adds.
pub trait Arithmetic {
    /// a b + c.
    fn mul_add(a: f32, b: f32, c: f32) -> f32;
}

/// Rounds the product, then the sum.
pub struct Plain;

/// Rounds once; fast only where the processor has an instruction for it.
pub struct Fused;

impl Arithmetic for Plain {
    #[inline(always)]
    fn mul_add(a: f32, b: f32, c: f32) -> f32 {
        a * b + c
    }
}

impl Arithmetic for Fused {
    #[inline(always)]
    fn mul_add(a: f32, b: f32, c: f32) -> f32 {
        a.mul_add(b, c)
    }
}

/// A kernel that is compiled for each class with that class's arithmetic.
pub trait Kernel {
    /// What it returns.
    type Output;

    /// Runs it. To be `#[inline(always)]`, as its callees.
    fn run<A: Arithmetic>(self) -> Self::Output;
}

/// The vector width that kernels run at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum SimdClass {
    /// What the compiler's target offers by itself.
    Portable,
    /// 256 bits.
    Avx2,
    /// 512 bits.
    Avx512,
}

impl SimdClass {
    /// Every class, narrowest first.
    pub const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The widest class of this processor.
    #[must_use]
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let has_avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            let has_avx512 =
                is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl");
            if has_avx2 {
                return if has_avx512 { Self::Avx512 } else { Self::Avx2 };
            }
        }
        Self::Portable
    }

    /// The name used in rows, recordings and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The class of that name; `None` if there is none. A class that this processor lacks is
    /// accepted and runs as the widest that it has.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|class| class.name() == name)
    }

    /// Runs `kernel` compiled for this class with its arithmetic, or for the widest class the
    /// processor has if that is narrower.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        if self.min(Self::detect()) == Self::Portable {
            kernel.run::<Plain>()
        } else {
            self.widen(
                #[inline(always)]
                || kernel.run::<Fused>(),
            )
        }
    }

    /// Runs `kernel` compiled for this class, or for the widest class the processor has if
    /// that is narrower.
    ///
    /// Only what is inlined into the closure is widened, so write
    /// `class.vectorize(#[inline(always)] || ...)` and keep its callees `#[inline(always)]`.
    #[inline]
    pub fn vectorize<R>(self, kernel: impl FnOnce() -> R) -> R {
        if self.min(Self::detect()) == Self::Portable { kernel() } else { self.widen(kernel) }
    }

    /// For the wide classes, when the processor has been seen to have them.
    #[inline]
    fn widen<R>(self, kernel: impl FnOnce() -> R) -> R {
        #[cfg(target_arch = "x86_64")]
        #[allow(unsafe_code, reason = "a function with target features is unsafe to call")]
        if self.min(Self::detect()) == Self::Avx512 {
            // SAFETY: `detect` has just seen the features that the function is compiled with.
            unsafe { with_avx512(kernel) }
        } else {
            // SAFETY: both callers have seen with `detect` that this is a wide class, and any
            // that is has these features.
            unsafe { with_avx2(kernel) }
        }
        #[cfg(not(target_arch = "x86_64"))]
        kernel()
    }
}

impl fmt::Display for SimdClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx2,fma")]
fn with_avx512<R>(kernel: impl FnOnce() -> R) -> R {
    kernel()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn with_avx2<R>(kernel: impl FnOnce() -> R) -> R {
    kernel()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_parse_back() {
        for class in SimdClass::ALL {
            assert_eq!(SimdClass::parse(class.name()), Some(class));
        }
        assert_eq!(SimdClass::parse("sse9"), None);
    }

    #[test]
    fn a_kernel_rounds_once_in_both_wide_classes_and_twice_in_the_portable_one() {
        struct Square(f32);
        impl Kernel for Square {
            type Output = f32;
            #[inline(always)]
            fn run<A: Arithmetic>(self) -> f32 {
                A::mul_add(self.0, self.0, -1.0 - 2.0 * f32::EPSILON)
            }
        }
        let run = |class: SimdClass| class.run(Square(1.0 + f32::EPSILON));
        assert_eq!(run(SimdClass::Portable), 0.0);
        if SimdClass::detect() > SimdClass::Portable {
            assert_eq!(run(SimdClass::Avx2), f32::EPSILON * f32::EPSILON);
            assert_eq!(run(SimdClass::Avx2), run(SimdClass::Avx512));
        }
    }

    #[test]
    fn closures_compute_the_same_bits_in_all_classes() {
        let x: Vec<f32> = (0..1000).map(|i| (i as f32 * 0.37).sin()).collect();
        let run = |class: SimdClass| {
            let mut y = x.clone();
            class.vectorize(
                #[inline(always)]
                || {
                    for (y, x) in y.iter_mut().zip(&x) {
                        *y = (*y * 1.1 + x * x - 0.3) / (2.0 + *x);
                    }
                },
            );
            y.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
        };
        let portable = run(SimdClass::Portable);
        assert_ne!(portable, x.iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        assert_eq!(portable, run(SimdClass::Avx2));
        assert_eq!(portable, run(SimdClass::Avx512));
    }
}
