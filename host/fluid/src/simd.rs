//! One build, every machine: kernels are compiled for several vector widths and the
//! widest that the processor has is called at run time.
//!
//! Nothing here multiplies and adds in one rounding, and no sum is reordered, so all classes
//! compute the same bits: a class is a speed, never a result.

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
            if is_x86_feature_detected!("avx2") {
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
        #[cfg(target_arch = "x86_64")]
        #[allow(unsafe_code, reason = "a function with target features is unsafe to call")]
        match self.min(Self::detect()) {
            // SAFETY: `detect` has just seen the features that the function is compiled with.
            Self::Avx512 => unsafe { with_avx512(kernel) },
            // SAFETY: as above.
            Self::Avx2 => unsafe { with_avx2(kernel) },
            Self::Portable => kernel(),
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
#[target_feature(enable = "avx512f,avx512vl")]
fn with_avx512<R>(kernel: impl FnOnce() -> R) -> R {
    kernel()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
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
