//! Axes: from values to pixels, and where the ticks go.

/// How values are spaced along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// By their decimal logarithm; values that are not above zero have no place.
    Log10,
}

/// An axis and its words.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Name and unit, for instance `"force [N]"`.
    pub label: String,
    /// How values are spaced.
    pub scale: Scale,
    /// Lowest and highest value shown; if `None`, as far as series and spans go and a little
    /// further.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// An even axis as long as its series.
    #[must_use]
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis as long as its series.
    #[must_use]
    pub fn log10(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Log10, range: None }
    }
}

/// Lowest and highest of the `values` that `scale` can show, if there is one.
pub(super) fn extent(scale: Scale, values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.filter(|value| placed(scale, *value).is_some()).fold(None, |range, value| {
        let [low, high] = range.unwrap_or([value; 2]);
        Some([low.min(value), high.max(value)])
    })
}

/// Place of a value along an endless axis; `None` if it has none.
fn placed(scale: Scale, value: f64) -> Option<f64> {
    let place = match scale {
        Scale::Linear => value,
        Scale::Log10 if value > 0.0 => value.log10(),
        Scale::Log10 => return None,
    };
    // Beyond this, differences of places overflow.
    (place.abs() < 1e300).then_some(place)
}

/// An axis laid on pixels.
#[derive(Clone, Debug)]
pub(super) struct Ruler {
    scale: Scale,
    /// Places of the two ends.
    places: [f64; 2],
    /// Pixels of the two ends.
    ends_px: [f64; 2],
}

/// A mark on an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) at_px: f64,
    /// Its number; `None` for the small marks between numbers.
    pub(super) label: Option<String>,
}

impl Ruler {
    /// `axis` for `values`, between two pixels, with `margin` (a part of its length) on each side
    /// of the values.
    pub(super) fn new(
        axis: &Axis,
        values: impl Iterator<Item = f64>,
        ends_px: [f64; 2],
        margin: f64,
    ) -> Self {
        let scale = axis.scale;
        let fixed = axis.range.and_then(|[from, to]| {
            let [from, to] = [placed(scale, from)?, placed(scale, to)?];
            Some([from.min(to), from.max(to)])
        });
        let whole =
            extent(scale, values).map(|range| range.map(|v| placed(scale, v).unwrap_or(0.0)));
        let [low, high] = fixed.or(whole).unwrap_or([0.0, 1.0]);
        let least = 1e-9 * low.abs().max(high.abs()).max(1e-9);
        let spread = if high - low > least {
            if fixed.is_some() { 0.0 } else { margin * (high - low) }
        } else {
            0.5 * low.abs().max(1e-3)
        };
        Self { scale, places: [low - spread, high + spread], ends_px }
    }

    /// Pixel of a value; `None` if it has no place on such an axis.
    pub(super) fn px(&self, value: f64) -> Option<f64> {
        placed(self.scale, value).map(|place| self.place_px(place))
    }

    /// Pixel of a value, brought into the axis: minus infinity is at its lower end.
    pub(super) fn px_within(&self, value: f64) -> f64 {
        let [low, high] = self.ends_px;
        let px = self.px(value).unwrap_or(if value > 0.0 { high } else { low });
        px.clamp(low.min(high), low.max(high))
    }

    fn place_px(&self, place: f64) -> f64 {
        let part = (place - self.places[0]) / (self.places[1] - self.places[0]);
        self.ends_px[0] + part * (self.ends_px[1] - self.ends_px[0])
    }

    /// All ticks, with numbers on at most about `numbers` of them.
    pub(super) fn ticks(&self, numbers: usize) -> Vec<Tick> {
        match self.scale {
            Scale::Linear => self.even_ticks(numbers.max(1)),
            Scale::Log10 => self.decade_ticks(numbers.max(1)),
        }
    }

    fn even_ticks(&self, numbers: usize) -> Vec<Tick> {
        let [low, high] = self.places;
        let step = round_step((high - low) / numbers as f64);
        let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
        let is_plain = low.abs().max(high.abs()) < 1e5 && step >= 1e-4;
        let first = (low / step).ceil();
        (0..=2 * numbers + 2)
            .map(|count| (first + count as f64) * step)
            .take_while(|value| *value <= high + 1e-9 * step)
            .map(|value| {
                // Adding zero turns -0 into 0.
                let value = if value.abs() < 1e-9 * step { 0.0 } else { value };
                let label =
                    if is_plain { format!("{value:.decimals$}") } else { format!("{value:.1e}") };
                Tick { at_px: self.place_px(value), label: Some(label) }
            })
            .collect()
    }

    fn decade_ticks(&self, numbers: usize) -> Vec<Tick> {
        let [low, high] = self.places;
        let decades = high.floor() - low.floor() + 1.0;
        let stride = (decades / numbers as f64).ceil().clamp(1.0, 1e3) as i32;
        // Within few decades the numbers between them are needed too.
        let has_few = high - low < 2.0;
        let mut ticks = Vec::new();
        for decade in (low.floor() as i32..=high.floor() as i32).take(1000) {
            for digit in 1..=9 {
                let place = f64::from(decade) + f64::from(digit).log10();
                if place < low - 1e-9 || place > high + 1e-9 || (stride > 1 && digit > 1) {
                    continue;
                }
                let is_numbered = match digit {
                    1 => decade.rem_euclid(stride) == 0,
                    2 | 5 => has_few,
                    _ => false,
                };
                let label = is_numbered.then(|| format!("{digit}e{decade}"));
                ticks.push(Tick { at_px: self.place_px(place), label });
            }
        }
        ticks
    }
}

/// The least of 1, 2 and 5 times a power of ten that is no less than `step`.
fn round_step(step: f64) -> f64 {
    let decade = 10_f64.powf(step.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * decade).into_iter().find(|s| *s >= step);
    step.filter(|step| step.is_normal()).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ruler: &Ruler, numbers: usize) -> Vec<String> {
        ruler.ticks(numbers).into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        let axis = Axis { range: Some([-0.25, 1.0]), ..Axis::linear("") };
        let ruler = Ruler::new(&axis, std::iter::empty(), [0.0, 100.0], 0.1);
        assert_eq!(labels(&ruler, 6), ["0.0", "0.5", "1.0"].map(String::from));
        assert_eq!(ruler.px(1.0), Some(100.0));
    }

    #[test]
    fn decades_are_numbered_and_what_is_not_above_zero_has_no_place() {
        let values = [1e-3, 10.0, 0.0, f64::NAN];
        let ruler = Ruler::new(&Axis::log10(""), values.into_iter(), [0.0, 400.0], 0.0);
        assert_eq!(labels(&ruler, 9), ["1e-3", "1e-2", "1e-1", "1e0", "1e1"].map(String::from));
        assert_eq!(ruler.px(0.1), Some(200.0));
        assert_eq!(ruler.px(-1.0), None);
    }

    #[test]
    fn what_lies_beyond_an_axis_is_brought_to_its_ends() {
        let axis = Axis { range: Some([1.0, 0.01]), ..Axis::log10("") };
        let ruler = Ruler::new(&axis, std::iter::empty(), [200.0, 0.0], 0.0);
        let ends = [f64::NEG_INFINITY, 0.0, 0.1, 7.0, f64::INFINITY].map(|v| ruler.px_within(v));
        assert_eq!(ends, [200.0, 200.0, 100.0, 0.0, 0.0]);
    }

    #[test]
    fn one_value_alone_has_an_axis_around_it() {
        let ruler = Ruler::new(&Axis::linear(""), [5.0].into_iter(), [0.0, 100.0], 0.1);
        assert_eq!(ruler.px(5.0), Some(50.0));
    }
}
