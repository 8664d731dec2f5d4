//! One build, every machine: kernels are compiled for several vector widths and the
//! widest that the processor has is called at run time.
//!
//! No sum is reordered, so that classes differ in their bits only where a kernel asks for
//! [`SimdClass::multiply_add`], and 256 and 512 bits not even there.

use std::fmt;

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
            if is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl") {
                return Self::Avx512;
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                return Self::Avx2;
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

    /// Runs `kernel` compiled for this class, or for the widest class the processor has if
    /// that is narrower.
    ///
    /// Only what is inlined into the closure is widened, so write
    /// `class.vectorize(#[inline(always)] || ...)` and keep its callees `#[inline(always)]`.
    #[inline]
    pub fn vectorize<R>(self, kernel: impl FnOnce() -> R) -> R {
        self.vectorize_as(
            #[inline(always)]
            |_| kernel(),
        )
    }

    /// As [`SimdClass::vectorize`], and tells the kernel the class that it is compiled for: a
    /// constant there, so that a choice by class costs nothing.
    #[inline]
    pub fn vectorize_as<R>(self, kernel: impl FnOnce(Self) -> R) -> R {
        #[cfg(target_arch = "x86_64")]
        #[allow(unsafe_code, reason = "a function with target features is unsafe to call")]
        match self.min(Self::detect()) {
            // SAFETY: `detect` has just seen the features that the function is compiled with.
            Self::Avx512 => unsafe { with_avx512(kernel) },
            // SAFETY: as above.
            Self::Avx2 => unsafe { with_avx2(kernel) },
            Self::Portable => kernel(Self::Portable),
        }
        #[cfg(not(target_arch = "x86_64"))]
        kernel(Self::Portable)
    }

    /// a b + c: rounded once where [`SimdClass::vectorize_as`] says that the processor can.
    #[inline(always)]
    #[must_use]
    pub fn multiply_add(self, a: f32, b: f32, c: f32) -> f32 {
        if self == Self::Portable { a * b + c } else { a.mul_add(b, c) }
    }
}

impl fmt::Display for SimdClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl")]
fn with_avx512<R>(kernel: impl FnOnce(SimdClass) -> R) -> R {
    kernel(SimdClass::Avx512)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn with_avx2<R>(kernel: impl FnOnce(SimdClass) -> R) -> R {
    kernel(SimdClass::Avx2)
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
    fn products_and_sums_are_rounded_once_or_twice() {
        let [a, b, c] = [1.0 + f32::EPSILON, 1.0 - f32::EPSILON, -1.0].map(std::hint::black_box);
        for asked in SimdClass::ALL {
            let (class, sum) = asked.vectorize_as(
                #[inline(always)]
                |class| (class, class.multiply_add(a, b, c)),
            );
            assert_eq!(class, asked.min(SimdClass::detect()));
            let once = -f32::EPSILON * f32::EPSILON;
            assert_eq!(sum, if class == SimdClass::Portable { 0.0 } else { once });
        }
    }

    #[test]
    fn all_classes_compute_the_same_bits() {
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
