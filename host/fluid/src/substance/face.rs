//! What a face carries: the mean fraction of the slab that crosses it within a sweep.
//!
//! The slab lies in the upwind cell, share c of its width. Its mean comes from the quartic
//! whose cell means fit the upwind cell and two neighbours on either side (the fifth-order
//! member of the family of Leonard 1991), in Newton's form. It is then bounded:
//!
//! - what crosses, and what stays, is between 0 and the highest fraction that was ever brought
//!   in (the maximum principle in the manner of Zhang, Shu 2010, kept cell by cell);
//! - unless the profile bends smoothly, what crosses is between the upwind cell and the next,
//!   and what stays between the upwind cell and the one before (Leonard's universal limiter):
//!   no ripples. A smooth extremum is exempt, and so is not clipped turn after turn.
//!
//! Each new fraction is a mean, with positive weights, of what stayed and what came in.

/// Smooth means that three neighbouring second differences agree in sign and within this factor.
const SMOOTH_WITHIN: f32 = 4.0;

/// A face along one axis, with what lies around it.
#[derive(Clone, Copy)]
pub struct Face {
    /// Differences of the fraction across faces -2 to 2 as seen from this one; 0 at a wall.
    pub steps: [f32; 5],
    /// Fraction below and above.
    pub beside: [f32; 2],
    /// Volume, in cells, that passes the faces -1, 0 and 1.
    pub flow: [f32; 3],
    /// 1 / volume of the cells below and above.
    pub per_volume: [f32; 2],
    /// No fraction may exceed this.
    pub highest: f32,
}

impl Face {
    /// Volume of the substance, in cells, that passes upwards.
    #[inline(always)]
    pub fn flux(self) -> f32 {
        let Self { steps: d, beside, flow, per_volume, highest } = self;
        let up = flow[1] > 0.0;
        let pick = |up_value: f32, down_value: f32| if up { up_value } else { down_value };
        // Against the axis all differences change sign, and so does what follows from them: it is
        // enough to change that of the result.
        let here = pick(beside[0], beside[1]);
        let (next, last) = (d[2], pick(d[1], d[3]));
        let bend = next - last;
        let bend_next = pick(d[3], d[1]) - next;
        let bend_last = last - pick(d[0], d[4]);
        // What leaves the upwind cell here, and altogether, in shares of it.
        let per_volume = pick(per_volume[0], per_volume[1]);
        let c = flow[1].abs() * per_volume;
        let other = pick(-flow[0], flow[2]);
        let all = lower(c + higher(other, 0.0) * per_volume, 1.0);
        let (third, last_third) = (bend_next - bend, bend - bend_last);
        let fourth = (2.0 + c) * (third - last_third) * (1.0 / 120.0);
        let third = (2.0 - c) * (third * (1.0 / 24.0) - fourth);
        let wanted = (1.0 - c) * (0.5 * next - (1.0 + c) * (bend * (1.0 / 6.0) + third));
        let lever = lever(all);
        let monotone = within_both(wanted, next, lever * last);
        let excess = if is_smooth(bend_last, bend, bend_next) { wanted } else { monotone };
        let excess = pick(excess, -excess);
        let room = highest - here;
        let most = lower(room, lever * here);
        let least = -lower(here, lever * room);
        flow[1] * (here + higher(lower(excess, most), least))
    }
}

/// Three second differences of a profile that is smooth, up to its extremes: the range from
/// the lowest to the highest is narrow and on one side of 0. (Their products would tell, too,
/// but those of traces are subnormal numbers, which are slow.)
#[inline(always)]
fn is_smooth(a: f32, b: f32, c: f32) -> bool {
    let least = lower(lower(a, b), c);
    let most = higher(higher(a, b), c);
    (SMOOTH_WITHIN * least >= most) | (SMOOTH_WITHIN * most <= least)
}

/// `value`, or the end of the range that it exceeds: the range is from 0 to the smaller of both
/// bounds, and nothing but 0 where their signs differ.
#[inline(always)]
fn within_both(value: f32, a: f32, b: f32) -> f32 {
    let most = higher(lower(a, b), 0.0);
    let least = lower(higher(a, b), 0.0);
    higher(lower(value, most), least)
}

/// What crosses may differ from the upwind cell by this times what stays may, if a share `all` of
/// the cell leaves: at most (1 - all) / all, from the first terms of its series. A bound that is
/// a little too tight is still a bound, at a fraction of the cost of a division.
#[inline(always)]
fn lever(all: f32) -> f32 {
    let rest = 1.0 - all;
    let square = rest * rest;
    (rest + square) * (1.0 + square)
}

/// The lower of both: a comparison and a selection, which the optimiser makes one instruction of.
#[inline(always)]
pub fn lower(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The higher of both.
#[inline(always)]
pub fn higher(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A face between the third and fourth of six cells.
    fn face(q: [f32; 6], flow: [f32; 3]) -> Face {
        let steps = std::array::from_fn(|f| q[f + 1] - q[f]);
        Face { steps, beside: [q[2], q[3]], flow, per_volume: [1.0; 2], highest: 1.0 }
    }

    #[test]
    fn quartics_are_carried_exactly() {
        // Means over cells of width 1 of x^4 / 1300, from its integral; the face is at x = 3.
        let integral = |x: f64| x.powi(5) / 5.0 / 1300.0;
        let q: [f32; 6] =
            std::array::from_fn(|i| (integral(i as f64 + 1.0) - integral(i as f64)) as f32);
        for c in [0.1, 0.5, 0.9] {
            let up = integral(3.0) - integral(3.0 - c);
            let down = integral(3.0) - integral(3.0 + c);
            let c = c as f32;
            assert!((f64::from(face(q, [c; 3]).flux()) - up).abs() < 1e-7);
            assert!((f64::from(face(q, [-c; 3]).flux()) - down).abs() < 1e-7);
        }
    }

    #[test]
    fn a_front_keeps_its_sides_and_an_even_field_its_value() {
        assert_eq!(face([0.0, 0.0, 0.0, 1.0, 1.0, 1.0], [0.4; 3]).flux(), 0.0);
        assert_eq!(face([1.0, 1.0, 1.0, 0.0, 0.0, 0.0], [-0.4; 3]).flux(), 0.0);
        assert_eq!(face([0.5; 6], [0.25; 3]).flux(), 0.125);
    }

    proptest! {
        #[test]
        fn what_crosses_and_what_stays_is_within_bounds(
            q in proptest::array::uniform6(0f32..1.0),
            c in 0f32..1.0,
            shared in 0f32..1.0,
        ) {
            // The cell below the face loses c in all, part of it through its other face.
            let out = face(q, [-c * shared, c * (1.0 - shared), 0.3]).flux();
            let mirrored = [q[4], q[3], q[2], q[1], q[0], q[0]];
            let back = face(mirrored, [-c * (1.0 - shared), c * shared, 0.0]).flux();
            prop_assert!(out >= 0.0 && out <= c * (1.0 - shared) * (1.0 + 1e-6));
            let stays = q[2] - out - back;
            prop_assert!(stays > -2e-6 && stays < 1.0 - c + 2e-6, "{stays} {c}");
        }

        #[test]
        fn the_lever_is_never_too_long(all in 1e-3f32..1.0) {
            let exact = (1.0 - all) / all;
            prop_assert!(lever(all) <= exact + 1e-6);
            prop_assert!(all < 0.5 || lever(all) >= 0.93 * exact - 1e-6);
        }
    }
}
