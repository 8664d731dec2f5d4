//! Lines of values in an array, and what is made of others.

/// A line of ghosts or of what they are made of: where it starts, and the step along it.
#[derive(Clone, Copy)]
pub struct Line {
    /// Index of its first value.
    pub start: usize,
    /// From one to the next.
    pub step: usize,
    /// Their number.
    pub len: usize,
}

impl Line {
    /// The same that starts elsewhere.
    pub fn from(self, start: usize) -> Self {
        Self { start, ..self }
    }

    /// Where its values lie, if they lie together.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start..self.start + self.len
    }
}

/// to = value.
pub fn set(array: &mut [f32], to: Line, value: f32) {
    if to.step == 1 {
        array[to.range()].fill(value);
    } else {
        derive(array, to, [to; 2], |_, _| value);
    }
}

/// to = sign from.
pub fn copy(array: &mut [f32], from: Line, to: Line, sign: f32) {
    if to.step == 1 && sign == 1.0 {
        array.copy_within(from.range(), to.start);
        return;
    }
    derive(array, to, [from; 2], |_, [from, _]| sign * from);
}

/// to = values.
pub fn put(array: &mut [f32], to: Line, values: &[f32]) {
    derive(array, to, [to; 2], |i, _| values[i]);
}

/// The ghost of the straight line through the side and the first value.
pub fn mirror(array: &mut [f32], first: Line, side: Option<&[f32]>, ghost: Line) {
    match side {
        None => copy(array, first, ghost, -1.0),
        Some(side) => derive(array, ghost, [first; 2], |i, [first, _]| 2.0 * side[i] - first),
    }
}

/// The ghost of the parabola through the side, half a spacing away, and the first two values.
pub fn extrapolate(array: &mut [f32], inner: [Line; 2], side: Option<&[f32]>, ghost: Line) {
    let parabola =
        |side: f32, [first, second]: [f32; 2]| (8.0 * side - 6.0 * first + second) * (1.0 / 3.0);
    match side {
        None => derive(array, ghost, inner, |_, inner| parabola(0.0, inner)),
        Some(side) => derive(array, ghost, inner, |i, inner| parabola(side[i], inner)),
    }
}

/// Sets each value of the line `to` to what `value` makes of its place and of those beside it in
/// two other lines.
#[inline(always)]
fn derive(
    array: &mut [f32],
    to: Line,
    [first, second]: [Line; 2],
    value: impl Fn(usize, [f32; 2]) -> f32,
) {
    if to.step > 1 && to.start.max(first.start).max(second.start) < to.step {
        // One value of each row: within a row no index can be out of bounds.
        for (i, row) in array.chunks_exact_mut(to.step).take(to.len).enumerate() {
            row[to.start] = value(i, [row[first.start], row[second.start]]);
        }
        return;
    }
    let lines = [to.range(), first.range(), second.range()];
    if to.step == 1
        && let Ok([to, first, second]) = array.get_disjoint_mut(lines)
    {
        for (i, to) in to.iter_mut().enumerate() {
            *to = value(i, [first[i], second[i]]);
        }
        return;
    }
    for i in 0..to.len {
        let [first, second] = [first, second].map(|line| array[line.start + i * line.step]);
        array[to.start + i * to.step] = value(i, [first, second]);
    }
}
