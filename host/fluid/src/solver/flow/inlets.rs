//! Velocities of sides that differ from place to place.

use glam::DVec3;

use crate::solver::{Refused, Side, flow::Flow, within};

/// The velocity of a side in m/s: `f(axis, end, point)` for a point in world metres on the lower
/// (`end` 0) or the upper (1) side across `axis`.
pub type SideVelocity<'a> = dyn Fn(usize, usize, DVec3) -> DVec3 + 'a;

/// Fastest that a side may move or let in.
const MAX_SPEED_M_S: f64 = 1e3;

/// What goes in may differ by this part from what comes out: it is what sampling makes of flows
/// that are the same.
const SAMPLING: f64 = 0.02;

/// A side, and its velocity at each of its points, by component.
#[derive(Default)]
pub(super) struct Sampled {
    axis: usize,
    end: usize,
    values: [Vec<f32>; 3],
}

impl Sampled {
    /// No less than the largest speed.
    fn largest_speed_m_s(&self) -> f64 {
        let [u, v, w] = &self.values;
        let sums = u.iter().zip(v).zip(w).map(|((u, v), w)| u.abs() + v.abs() + w.abs());
        f64::from(sums.fold(0.0, f32::max))
    }
}

impl Flow {
    /// Sets the velocities of all sides that are [`Side::Moving`] or [`Side::Inflow`], of which
    /// each point may have its own, from now on; call it again before a step for what changes in
    /// time. As with constant ones, what would move a wall out of its plane is left out.
    ///
    /// If no side is [`Side::Outflow`], as much has to go out as comes in: a difference of up to
    /// 2 % is taken for that of sampling, and all that goes out is scaled to make up for it.
    ///
    /// # Errors
    /// [`Refused`] if a value is not finite or above 1000 m/s, or more than that comes in or goes
    /// out; nothing is changed.
    ///
    /// A parabola flows in:
    /// ```
    /// use cauldron_fluid::{Grid, Vessel, solver::{Setup, Side, Sides, Solver, flow::Flow}};
    /// use glam::{DVec3, Vec3};
    ///
    /// let sides = Sides::all(Side::FreeSlip)
    ///     .with(0, [Side::Inflow(Vec3::X), Side::Outflow])
    ///     .with(1, [Side::NoSlip; 2]);
    /// let grid = Grid { cells: [16, 16, 1], ..Grid::unit_cube(16) };
    /// let setup = Setup { viscosity_m2_s: 0.1, sides, ..Setup::new(grid, Vessel::Box) };
    /// let mut flow = Flow::new(&setup)?;
    /// let developed = |p: DVec3| 4.0 * p.y * (1.0 - p.y) * DVec3::X;
    /// flow.set_side_velocities(&|_, _, point| developed(point))?;
    /// flow.set_velocity(&developed)?;
    /// for _ in 0..20 {
    ///     flow.step(0.02)?;
    /// }
    /// assert!((flow.velocity_at(Vec3::new(0.9, 0.5, 0.0)).x - 1.0).abs() < 0.01);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn set_side_velocities(&mut self, velocity_m_s: &SideVelocity<'_>) -> Result<(), Refused> {
        let mut sampled = std::mem::take(&mut self.sampled_sides);
        let is_sound = self
            .sample_sides(&mut sampled, velocity_m_s)
            .and_then(|()| self.balance_sides(&mut sampled));
        if is_sound.is_ok() {
            self.side_speed_m_s =
                sampled.iter().map(Sampled::largest_speed_m_s).fold(0.0, f64::max);
            for Sampled { axis, end, values } in &mut sampled {
                self.ghosts.stick_to(*axis, *end, values);
            }
            self.sides_have_changed();
        }
        self.sampled_sides = sampled;
        is_sound
    }

    /// The velocities of all sides that have one. What was sampled before makes room for them.
    fn sample_sides(
        &self,
        sampled: &mut Vec<Sampled>,
        velocity_m_s: &SideVelocity<'_>,
    ) -> Result<(), Refused> {
        let sides = self.sides.0.iter().enumerate().flat_map(|(axis, both)| {
            both.iter().enumerate().map(move |(end, side)| (axis, end, side))
        });
        let given = sides.filter(|(.., side)| matches!(side, Side::Moving(_) | Side::Inflow(_)));
        for (place, (axis, end, side)) in given.enumerate() {
            if sampled.len() == place {
                sampled.push(Sampled::default());
            }
            let is_wall = matches!(side, Side::Moving(_));
            let to = &mut sampled[place];
            (to.axis, to.end) = (axis, end);
            self.sample_side(to, is_wall, velocity_m_s)?;
        }
        Ok(())
    }

    /// The velocity at the points of a side, and of what lies beyond its edges at these.
    fn sample_side(
        &self,
        to: &mut Sampled,
        is_wall: bool,
        velocity_m_s: &SideVelocity<'_>,
    ) -> Result<(), Refused> {
        let (axis, end) = (to.axis, to.end);
        let cells = self.layout.cells;
        let padded = cells.map(|n| n + 2);
        let [a, b] = across(axis);
        for (c, values) in to.values.iter_mut().enumerate() {
            values.clear();
            values.resize(self.layout.points_of_side(axis), 0.0);
            if is_wall && c == axis {
                continue;
            }
            for place in 0..padded[a] * padded[b] {
                let mut face = [0; 3];
                (face[a], face[b]) = (place % padded[a], place / padded[a]);
                let point = std::array::from_fn(|d| match d {
                    d if d == axis => (end * cells[d]) as f64,
                    d => {
                        let middle = if d == c { 0.0 } else { 0.5 };
                        (face[d] as f64 - 1.0 + middle).clamp(0.0, cells[d] as f64)
                    }
                });
                let point = self.grid.origin_in_world_m.as_dvec3()
                    + f64::from(self.grid.spacing_m) * DVec3::from_array(point);
                let value = velocity_m_s(axis, end, point)[c];
                within("velocity of a side in m/s", value, MAX_SPEED_M_S)?;
                values[self.layout.place_on_side(axis, face)] = value as f32;
            }
        }
        Ok(())
    }

    /// Makes as much go out as comes in where nothing else lets it.
    fn balance_sides(&self, sampled: &mut [Sampled]) -> Result<(), Refused> {
        if self.sides.0.iter().flatten().any(|side| *side == Side::Outflow) {
            return Ok(());
        }
        let passing: [f64; 2] =
            sampled.iter().fold([0.0; 2], |sums, Sampled { axis, end, values }| {
                let mut sums = sums;
                self.each_of_side(*axis, *end, |place, area| {
                    let inward = f64::from(values[*axis][place]) * [1.0, -1.0][*end] * area;
                    sums[usize::from(inward < 0.0)] += inward.abs();
                });
                sums
            });
        let [into, out] = passing;
        if (into - out).abs() > SAMPLING * into.max(out) {
            let area_m2 = f64::from(self.grid.spacing_m).powi(2);
            let what = "net inflow in m^3/s without an outflow";
            return Err(Refused { what, value: (into - out) * area_m2 });
        }
        for Sampled { axis, end, values } in sampled.iter_mut().filter(|_| out > 0.0) {
            for value in &mut values[*axis] {
                if (*value > 0.0) == (*end == 1) {
                    *value *= (into / out) as f32;
                }
            }
        }
        Ok(())
    }

    /// Calls `visit(place, open part)` for the faces of a side, as the vessel leaves them. What
    /// obstacles take of them is made up for within.
    fn each_of_side(&self, axis: usize, end: usize, mut visit: impl FnMut(usize, f64)) {
        let cells = self.layout.cells;
        let [a, b] = across(axis);
        for place in 0..cells[a] * cells[b] {
            let mut face = [0; 3];
            (face[axis], face[a], face[b]) =
                (end * cells[axis], place % cells[a], place / cells[a]);
            let at = self.layout.index(face[0], face[1], face[2]);
            visit(self.layout.place_on_side(axis, face.map(|f| f + 1)), self.bare().mass(axis, at));
        }
    }
}

/// The other two axes.
fn across(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}
