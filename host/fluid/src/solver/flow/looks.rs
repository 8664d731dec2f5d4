//! Looks: what makes a coarse flow look livelier, or calmer, than its equations have it. They
//! add error to every flow that is known, so they are off unless they are asked for; then they
//! change the velocity before each step.
//!
//! - Confinement spins eddies up that the grid is too coarse for (Steinhoff, Underhill 1994;
//!   Fedkiw, Stam, Jensen 2001): du = eps h (N x w) dt, w being the vorticity and N the direction
//!   in which |w| grows.
//! - Sub-grid viscosity takes what eddies below the grid would take (Smagorinsky 1963):
//!   nu_t = (C h)^2 |S|, |S|^2 = 2 S:S, held to what one explicit step bears.

use std::mem;

use crate::solver::{
    Refused,
    flow::{
        Flow,
        engine::Engine,
        field::{Field, Layout, Run, Star, Vector, components, cut, cut_mut},
        ghosts::Fill,
        inventory::bytes,
    },
    within,
};

/// Most that confinement adds to a velocity in a step, of the velocity across a cell.
const MOST_SPIN: f64 = 0.1;

/// nu_t dt / h^2 at most; what is taken from a face is never more than it has.
const MOST_DIFFUSION: f32 = 1.0 / 14.0;

/// What a flow is to look like besides what it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Looks {
    /// Confinement eps, in 1/s; 0 is off, 1 to 10 shows. It adds energy.
    pub confinement_per_s: f32,
    /// Smagorinsky's C of the sub-grid viscosity; 0 is off, 0.1 to 0.2 is usual.
    pub smagorinsky: f32,
}

/// Looks, and room for them.
pub(super) struct Looking {
    looks: Looks,
    /// Vorticity of cells times their spacing, then what it pushes with.
    spin: Vector,
    /// Its magnitude, or the sub-grid viscosity times dt / h^2.
    size: Field,
}

impl Looking {
    pub(super) fn bytes(&self) -> usize {
        bytes(self.spin.iter().chain([&self.size]))
    }
}

impl Flow {
    /// Sets how the flow is to look from the next step on; at first it looks as it is.
    ///
    /// # Errors
    /// [`Refused`] if a strength is negative, not finite or above 1000; nothing is changed then.
    pub fn set_looks(&mut self, looks: Looks) -> Result<(), Refused> {
        let Looks { confinement_per_s, smagorinsky } = looks;
        for (what, value) in
            [("confinement_per_s", confinement_per_s), ("smagorinsky", smagorinsky)]
        {
            let value = f64::from(value);
            let sound = if value < 0.0 { f64::NAN } else { value };
            within(what, sound, 1e3).map_err(|refused| Refused { value, ..refused })?;
        }
        if looks == Looks::default() {
            self.looks = None;
            return Ok(());
        }
        let layout = self.layout;
        let room = || Looking {
            looks,
            spin: [layout.zeros(), layout.zeros(), layout.zeros()],
            size: layout.zeros(),
        };
        self.looks.get_or_insert_with(|| Box::new(room())).looks = looks;
        Ok(())
    }

    /// Changes the velocity as looks have it, before a step of `dt_s`. What that does to its
    /// energy is no business of the guard.
    pub(super) fn dress(&mut self, dt_s: f64) {
        let Some(mut looking) = self.looks.take() else { return };
        let Looking { looks, spin, size } = &mut *looking;
        let Self { layout, faces, ghosts, velocity, stage: [out, _], pool, simd, .. } = self;
        let on = Engine { pool, simd: *simd, faces };
        if looks.confinement_per_s > 0.0 {
            set_spin(on, layout, components(velocity), spin, size);
            ghosts.extend_cells(size);
            let push = (f64::from(looks.confinement_per_s) * dt_s).min(MOST_SPIN) as f32;
            confine(on, layout, size, spin, push);
            spin.iter_mut().for_each(|spin| ghosts.extend_cells(spin));
            push_faces(on, layout, spin, velocity);
            ghosts.fill(velocity, Fill::Unprojected);
        }
        if looks.smagorinsky > 0.0 {
            let reach = (dt_s / f64::from(self.grid.spacing_m)) as f32;
            set_viscosity(
                on,
                layout,
                components(velocity),
                size,
                looks.smagorinsky.powi(2) * reach,
            );
            ghosts.extend_cells(size);
            calm(on, layout, components(velocity), size, out);
            mem::swap(velocity, out);
            ghosts.fill(velocity, Fill::Inside);
        }
        self.looks = Some(looking);
        self.survey = None;
    }
}

/// Differences across the middle of a cell between two components, in two directions: of c
/// along b, and of b along c, b and c being the axes after `a`; each in velocity per spacing.
#[inline(always)]
fn shears<'a>(
    layout: &Layout,
    velocity: [&'a [f32]; 3],
    a: usize,
    Run { at, len, .. }: Run,
) -> impl Fn(usize) -> (f32, f32) + 'a {
    let (b, c) = ((a + 1) % 3, (a + 2) % 3);
    let (sb, sc) = (layout.strides()[b], layout.strides()[c]);
    let along = |field: &'a [f32], far: usize, near: usize| {
        [at + far, at - far, at + far + near, at + near - far].map(|at| cut(field, at, len))
    };
    let (of_c, of_b) = (along(velocity[c], sb, sc), along(velocity[b], sc, sb));
    move |i| {
        let mean = |f: &[&[f32]; 4]| 0.25 * ((f[0][i] - f[1][i]) + (f[2][i] - f[3][i]));
        (mean(&of_c), mean(&of_b))
    }
}

/// spin = h w and its magnitude, in cells.
fn set_spin(
    on: Engine<'_>,
    layout: &Layout,
    velocity: [&[f32]; 3],
    spin: &mut Vector,
    size: &mut Field,
) {
    let [x, y, z] = spin.each_mut().map(|field| layout.planes(field));
    on.pool.planes([x, y, z, layout.planes(size)], [layout.plane; 4], |k, [x, y, z, size]| {
        on.rows(
            layout,
            k,
            #[inline(always)]
            |run, _| {
                let (to, len) = (run.to, run.len);
                let (size, liquid) = (cut_mut(size, to, len), cut(&on.faces.liquid, run.at, len));
                let [wx, wy, wz] = [cut_mut(x, to, len), cut_mut(y, to, len), cut_mut(z, to, len)];
                let about = [0, 1, 2].map(|a| shears(layout, velocity, a, run));
                for i in 0..len {
                    let [x, y, z] = [about[0](i), about[1](i), about[2](i)]
                        .map(|(of_c, of_b)| liquid[i] * (of_c - of_b));
                    (wx[i], wy[i], wz[i]) = (x, y, z);
                    size[i] = (x * x + y * y + z * z).sqrt();
                }
            },
        );
    });
}

/// spin = push N x spin.
fn confine(on: Engine<'_>, layout: &Layout, size: &Field, spin: &mut Vector, push: f32) {
    let outs = spin.each_mut().map(|field| layout.planes(field));
    on.pool.planes(outs, [layout.plane; 3], |k, [x, y, z]| {
        on.rows(
            layout,
            k,
            #[inline(always)]
            |Run { at, to, len }, _| {
                let size = Star::new(layout, size, at, len);
                let [x, y, z] = [cut_mut(x, to, len), cut_mut(y, to, len), cut_mut(z, to, len)];
                for i in 0..len {
                    let rise = [size.x, size.y, size.z].map(|(below, above)| above[i] - below[i]);
                    let steep = rise[0] * rise[0] + rise[1] * rise[1] + rise[2] * rise[2];
                    let scale = push / (steep.sqrt() + f32::MIN_POSITIVE);
                    let [n, w] = [rise.map(|rise| scale * rise), [x[i], y[i], z[i]]];
                    x[i] = n[1] * w[2] - n[2] * w[1];
                    y[i] = n[2] * w[0] - n[0] * w[2];
                    z[i] = n[0] * w[1] - n[1] * w[0];
                }
            },
        );
    });
}

/// Adds the mean of both cells to the velocity of each open face.
fn push_faces(on: Engine<'_>, layout: &Layout, push: &Vector, velocity: &mut Vector) {
    let outs = velocity.each_mut().map(|field| layout.planes(field));
    on.pool.planes(outs, [layout.plane; 3], |k, outs| {
        for (c, out) in outs.into_iter().enumerate() {
            let stride = layout.strides()[c];
            on.rows(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, _| {
                    let (u, open) = (cut_mut(out, to, len), cut(&on.faces.open[c], at, len));
                    let (here, behind) = (cut(&push[c], at, len), cut(&push[c], at - stride, len));
                    for i in 0..len {
                        u[i] += 0.5 * open[i] * (here[i] + behind[i]);
                    }
                },
            );
        }
    });
}

/// size = nu_t dt / h^2 in cells; `share` = C^2 dt / h.
fn set_viscosity(
    on: Engine<'_>,
    layout: &Layout,
    velocity: [&[f32]; 3],
    size: &mut Field,
    share: f32,
) {
    let strides = layout.strides();
    on.pool.planes([layout.planes(size)], [layout.plane], |k, [size]| {
        on.rows(
            layout,
            k,
            #[inline(always)]
            |run, _| {
                let Run { at, to, len } = run;
                let (size, liquid) = (cut_mut(size, to, len), cut(&on.faces.liquid, at, len));
                let across = [0, 1, 2]
                    .map(|c| (cut(velocity[c], at, len), cut(velocity[c], at + strides[c], len)));
                let about = [0, 1, 2].map(|a| shears(layout, velocity, a, run));
                for i in 0..len {
                    let mut square = 0.0;
                    for ((below, above), shear) in across.iter().zip(&about) {
                        let (stretch, (of_c, of_b)) = (above[i] - below[i], shear(i));
                        square += 2.0 * stretch * stretch + (of_c + of_b) * (of_c + of_b);
                    }
                    let viscosity = share * square.sqrt();
                    let held = if viscosity < MOST_DIFFUSION { viscosity } else { MOST_DIFFUSION };
                    size[i] = liquid[i] * held;
                }
            },
        );
    });
}

/// out = u + sum over the neighbours of nu (u_neighbour - u), nu between two faces being the mean
/// of that of the cells which touch both.
fn calm(
    on: Engine<'_>,
    layout: &Layout,
    velocity: [&[f32]; 3],
    viscosity: &Field,
    out: &mut Vector,
) {
    let strides = layout.strides();
    let outs = out.each_mut().map(|field| layout.planes(field));
    on.pool.planes(outs, [layout.plane; 3], |k, outs| {
        for (c, out) in outs.into_iter().enumerate() {
            let behind = strides[c];
            on.rows(
                layout,
                k,
                #[inline(always)]
                |Run { at, to, len }, _| {
                    let u = Star::new(layout, velocity[c], at, len);
                    let (out, open) = (cut_mut(out, to, len), cut(&on.faces.open[c], at, len));
                    let cells = (cut(viscosity, at - behind, len), cut(viscosity, at, len));
                    // Beside a face there are two cells in front and two behind.
                    let sides = [(0, u.x), (1, u.y), (2, u.z)].map(|(d, u)| {
                        let step = if d == c { 0 } else { strides[d] };
                        let two =
                            |at: usize| (cut(viscosity, at - behind, len), cut(viscosity, at, len));
                        (u, two(at - step), two(at + step))
                    });
                    for i in 0..len {
                        let (here, low, high) = (u.here[i], cells.0[i], cells.1[i]);
                        let mut sum = 0.0;
                        for (d, (u, below, above)) in sides.iter().enumerate() {
                            let beside =
                                |two: &(&[f32], &[f32])| 0.25 * (low + high + two.0[i] + two.1[i]);
                            let (low, high) =
                                if d == c { (low, high) } else { (beside(below), beside(above)) };
                            sum += low * (u.0[i] - here) + high * (u.1[i] - here);
                        }
                        out[i] = here + open[i] * sum;
                    }
                },
            );
        }
    });
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::DVec3;

    use super::*;
    use crate::{
        Grid, Vessel,
        solver::{Setup, Solver},
    };

    fn eddies(p: DVec3) -> DVec3 {
        let (x, y) = (4.0 * PI * p.x, 4.0 * PI * p.y);
        DVec3::new(x.sin() * y.cos(), -x.cos() * y.sin(), 0.0)
    }

    fn energy_j(looks: Looks) -> f64 {
        let mut flow = Flow::new(&Setup::new(Grid::unit_cube(16), Vessel::Box)).expect("a flow");
        flow.set_velocity(&eddies).expect("finite");
        flow.set_looks(looks).expect("in range");
        (0..20).for_each(|_| {
            flow.step(0.02).expect("finite");
        });
        flow.kinetic_energy_j()
    }

    #[test]
    fn confinement_spins_up_and_sub_grid_viscosity_calms() {
        let plain = energy_j(Looks::default());
        let spun = energy_j(Looks { confinement_per_s: 2.0, smagorinsky: 0.0 });
        let calmed = energy_j(Looks { confinement_per_s: 0.0, smagorinsky: 0.2 });
        assert!(spun > 1.01 * plain && spun < 10.0 * plain, "{spun} {plain}");
        assert!(calmed < 0.99 * plain && calmed > 0.1 * plain, "{calmed} {plain}");
    }

    /// A shear flow on the middle of the grid: nu_t = (C h)^2 |du/dy|, and a parabola of that
    /// changes by its slope.
    #[test]
    fn the_sub_grid_viscosity_is_that_of_smagorinsky() {
        let (layout, grid) = (Layout::new([8; 3]), Grid::unit_cube(8));
        let mut flow = Flow::new(&Setup::new(grid, Vessel::Box)).expect("a flow");
        flow.set_velocity(&|p| DVec3::new(3.0 * p.y, 0.0, 0.0)).expect("finite");
        let mut size = layout.zeros();
        let on = Engine { pool: &flow.pool, simd: flow.simd, faces: &flow.faces };
        let (c, dt_s, h) = (0.2f32, 1e-3f32, 0.125f32);
        set_viscosity(on, &layout, components(&flow.velocity), &mut size, c * c * dt_s / h);
        let found = size[layout.index(4, 4, 4)];
        let exact = (c * h).powi(2) * 3.0 * dt_s / (h * h);
        assert!((found / exact - 1.0).abs() < 1e-5, "{found} {exact}");
    }

    #[test]
    fn whatever_their_strength_flows_stay_finite() {
        for dt_s in [1e-4, 0.05, 2.0] {
            let mut flow = Flow::new(&Setup::new(Grid::unit_cube(8), Vessel::Box)).expect("a flow");
            flow.set_velocity(&|p| 100.0 * eddies(p)).expect("finite");
            let looks = Looks { confinement_per_s: 1e3, smagorinsky: 1e3 };
            flow.set_looks(looks).expect("in range");
            for _ in 0..50 {
                assert!(flow.step(dt_s).expect("finite").kinetic_energy_j.is_finite());
            }
        }
    }

    #[test]
    fn a_strength_that_makes_no_sense_is_refused_by_name() {
        let mut flow = Flow::new(&Setup::new(Grid::unit_cube(4), Vessel::Box)).expect("a flow");
        for bad in [-1.0, f32::NAN, 1e4] {
            let looks = Looks { confinement_per_s: bad, smagorinsky: 0.0 };
            assert_eq!(flow.set_looks(looks).expect_err("bad").what, "confinement_per_s");
            let looks = Looks { confinement_per_s: 0.0, smagorinsky: bad };
            assert_eq!(flow.set_looks(looks).expect_err("bad").what, "smagorinsky");
        }
    }
}
