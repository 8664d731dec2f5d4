//! Vessels from meshes that the tests write themselves: what is read, what is refused, and how
//! near the distances come to the truth.

use std::{fs, path::PathBuf};

use cauldron_fluid::{
    Grid, Vessel, scenes, surface,
    vessel::{Mesh, MeshError, MeshFault, MeshOf, cut::Cut},
};
use glam::Vec3;

const PI: f32 = std::f32::consts::PI;
type Soup = (Vec<Vec3>, Vec<[u32; 3]>);

/// A surface of revolution about the y axis: rings at (radius, height), outwards on the left of
/// the way. The seam's points are double, as exporters write them.
fn turned(profile: &[(f32, f32)], around: u32) -> Soup {
    let turn = |n: u32| (2.0 * PI * n as f32 / around as f32).sin_cos();
    let ring = |&(r, y): &(f32, f32)| {
        (0..=around).map(move |n| Vec3::new(r * turn(n).1, y, r * turn(n).0))
    };
    let points: Vec<Vec3> = profile.iter().flat_map(ring).collect();
    let quads = (0..profile.len() as u32 - 1).flat_map(|row| (0..around).map(move |n| (row, n)));
    let triangles = quads.flat_map(|(row, n)| {
        let (a, b) = (row * (around + 1) + n, (row + 1) * (around + 1) + n);
        [[a, b, b + 1], [a, b + 1, a + 1]]
    });
    (points, triangles.collect())
}

/// An arc of a circle about the origin, from below (-90 degrees) upwards.
fn arc(radius: f32, from_degrees: f32, to_degrees: f32, steps: usize) -> Vec<(f32, f32)> {
    let angle = |n: usize| from_degrees + (to_degrees - from_degrees) * n as f32 / steps as f32;
    let at = |n: usize| angle(n).to_radians().sin_cos();
    (0..=steps).map(|n| (radius * at(n).1, radius * at(n).0)).collect()
}

fn sphere(radius: f32) -> Soup {
    turned(&arc(radius, -90.0, 90.0, 40), 80)
}

/// A cauldron as it is modelled: hemisphere and cylinder, a wall with a thickness, an open top.
fn cauldron(thickness: f32, rim: f32) -> Soup {
    let mut profile = arc(0.4 + thickness, -90.0, 0.0, 24);
    profile.extend([(0.4 + thickness, rim), (0.4, rim)]);
    profile.extend(arc(0.4, 0.0, -90.0, 24));
    turned(&profile, 64)
}

/// A box from -0.5 to 0.5 with y up to 0.25, where cauldrons and bowls end.
fn grid(n: usize) -> Grid {
    let spacing_m = 1.0 / n as f32;
    Grid { cells: [n, 3 * n / 4, n], spacing_m, origin_in_world_m: Vec3::splat(-0.5) }
}

fn cube(edge: f32) -> Soup {
    let corner =
        |c: u32| edge * (Vec3::new((c & 1) as f32, (c >> 1 & 1) as f32, (c >> 2) as f32) - 0.5);
    let sides =
        [[0u32, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    ((0..8).map(corner).collect(), triangles.collect())
}

fn obj((points, triangles): &Soup) -> String {
    let mut text = String::from("# a mesh\nmtllib none.mtl\no thing\n");
    for p in points {
        text += &format!("v {} {} {}\n", p.x, p.y, p.z);
    }
    for [a, b, c] in triangles {
        text += &format!("f {}/1/1 {}//2 {}\n", a + 1, b + 1, i64::from(*c) - points.len() as i64);
    }
    text
}

/// A GLB of one mesh under nodes, `{}` being its bytes' and items' numbers.
fn glb((points, triangles): &Soup, nodes: &str) -> Vec<u8> {
    let mut bytes: Vec<u8> =
        points.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
    let split = bytes.len();
    bytes.extend(triangles.iter().flatten().flat_map(|corner| (*corner as u16).to_le_bytes()));
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let (all, count, corners) = (bytes.len(), points.len(), 3 * triangles.len());
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":{nodes},
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "buffers":[{{"byteLength":{all}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{split}}},
        {{"buffer":0,"byteOffset":{split},"byteLength":{}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{count},"type":"VEC3",
        "min":[-9,-9,-9],"max":[9,9,9]}},
        {{"bufferView":1,"componentType":5123,"count":{corners},"type":"SCALAR"}}]}}"#,
        all - split
    );
    json += &" ".repeat(json.len().next_multiple_of(4) - json.len());
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend((28 + json.len() as u32 + all as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json.as_bytes()), (b"BIN\0", &bytes)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// A folder of this test's own.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("cauldron-mesh-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder for temporary files");
    folder
}

fn vessel((points, triangles): Soup, grid: &Grid, of: MeshOf) -> Result<Vessel, MeshError> {
    Vessel::from_mesh(&Mesh::new(points, triangles)?, grid, of)
}

const WALL: MeshOf = MeshOf::Wall { inside_in_world_m: Vec3::new(0.05, -0.1, 0.02) };
/// Hemisphere of 0.4 and cylinder of 0.25 above it.
const CAULDRON_M3: f32 = PI * 0.16 * (0.25 + 2.0 / 3.0 * 0.4);

#[test]
fn files_hold_what_was_written_into_them() {
    let folder = folder("files");
    let round = sphere(0.4);
    // A sphere without its cap: what is below the rest surface.
    let exact_m3 = PI * (2.0 / 3.0 * 0.064 + 0.16 * 0.25 - 0.25f32.powi(3) / 3.0);
    let nodes = r#"[{"children":[1],"translation":[0.1,0,0]},
        {"mesh":0,"scale":[-2,2,2],"translation":[-0.1,0,0]}]"#;
    let half = (round.0.iter().map(|p| 0.5 * *p).collect(), round.1.clone());
    for (name, bytes) in [("ball.obj", obj(&round).into_bytes()), ("ball.glb", glb(&half, nodes))] {
        let path = folder.join(name);
        fs::write(&path, bytes).unwrap();
        let grid = grid(24);
        let ball = Vessel::from_mesh(&Mesh::read(&path).unwrap(), &grid, MeshOf::Liquid).unwrap();
        let measured_m3 = Cut::new(&grid, &ball).volume_m3() as f32;
        assert!((measured_m3 / exact_m3 - 1.0).abs() < 5e-3, "{name}: {measured_m3} {exact_m3}");
        let near = grid.corners().filter(|p| p.length() > 0.36);
        let wrong = near.map(|p| (ball.depth_inside_m(p) - 0.4 + p.length()).abs());
        let worst = wrong.fold(0.0, f32::max);
        assert!(worst < 1.5e-3, "{name}: {worst}, a facet's sagitta is 0.2e-3");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_cube_is_a_box_however_its_faces_look() {
    for inside_out in [false, true] {
        let (points, mut triangles) = cube(0.5);
        if inside_out {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        // Its lid is the rest surface, and no wall.
        let grid = Grid { cells: [20, 15, 20], ..grid(20) };
        let liquid = vessel((points, triangles), &grid, MeshOf::Liquid).unwrap();
        let measured_m3 = Cut::new(&grid, &liquid).volume_m3();
        assert!((measured_m3 - 0.125).abs() < 1e-3, "{measured_m3}");
        assert!((liquid.depth_inside_m(Vec3::new(0.0, 0.25, 0.0)) - 0.25).abs() < 1e-4);
    }
}

#[test]
fn a_thick_or_thin_cauldron_holds_liquid_up_to_the_top_of_the_box() {
    // From walls of two cells to one, with rims above the liquid and at its level.
    for (thickness, rim) in [(0.09, 0.3), (0.04, 0.25), (0.045, 0.45)] {
        let grid = grid(24);
        let pot = vessel(cauldron(thickness, rim), &grid, WALL).unwrap();
        let measured_m3 = Cut::new(&grid, &pot).volume_m3() as f32;
        assert!((measured_m3 / CAULDRON_M3 - 1.0).abs() < 5e-3, "{thickness}: {measured_m3}");
        assert!(pot.depth_inside_m(Vec3::new(0.0, 0.25, 0.0)) > 0.39);
        assert!(pot.depth_inside_m(Vec3::new(0.48, -0.48, 0.48)) < 0.0, "outside is not liquid");
    }
}

#[test]
fn an_open_bowl_of_no_thickness_holds_liquid_too() {
    let mut profile = arc(0.4, -90.0, 0.0, 24);
    profile.push((0.4, 0.3));
    let grid = grid(24);
    let bowl = vessel(turned(&profile, 64), &grid, MeshOf::Liquid).unwrap();
    let measured_m3 = Cut::new(&grid, &bowl).volume_m3() as f32;
    assert!((measured_m3 / CAULDRON_M3 - 1.0).abs() < 5e-3, "{measured_m3}");
}

#[test]
fn cracks_are_bridged() {
    let (points, mut triangles) = cauldron(0.09, 0.3);
    // Two triangles near the bottom, smaller than a cell.
    triangles.drain(200..202);
    let grid = grid(24);
    let pot = vessel((points, triangles), &grid, WALL).unwrap();
    let measured_m3 = Cut::new(&grid, &pot).volume_m3() as f32;
    assert!((measured_m3 / CAULDRON_M3 - 1.0).abs() < 5e-3, "{measured_m3}");
}

#[test]
fn what_no_vessel_can_be_made_of_is_refused_by_name() {
    let (points, triangles) = cauldron(0.09, 0.3);
    let without = |from: usize, to: usize| {
        let mut triangles = triangles.clone();
        triangles.drain(from..to);
        (points.clone(), triangles)
    };
    let whole = || (points.clone(), triangles.clone());
    let inside = |x: f32| MeshOf::Wall { inside_in_world_m: Vec3::new(x, 0.0, 0.0) };
    let (grid, n) = (grid(16), triangles.len());
    for (soup, of, words) in [
        (without(n - 1000, n), WALL, "open edges"),
        (without(0, 2000), WALL, "turn all faces outwards"),
        (cauldron(0.09, 0.1), WALL, "a rim below the top of the box"),
        (cauldron(0.01, 0.3), WALL, "thinner than two cells"),
        (whole(), inside(0.45), "is in the wall"),
        (whole(), inside(0.7), "is not in the grid's box"),
        (sphere(0.2), MeshOf::Liquid, "no liquid up to the rest surface"),
        ((vec![Vec3::ZERO; 3], vec![[0, 1, 2]]), MeshOf::Liquid, "no triangle with an area"),
        ((points.clone(), vec![]), MeshOf::Liquid, "no triangle"),
        ((vec![Vec3::NAN; 3], vec![[0, 1, 2]]), MeshOf::Liquid, "point 0 is [NaN"),
        ((vec![Vec3::splat(1e30); 3], vec![[0, 1, 2]]), MeshOf::Liquid, "units are metres"),
        ((vec![Vec3::ZERO; 3], vec![[0, 1, 7]]), MeshOf::Liquid, "corner 7, but there are 3"),
    ] {
        let said = vessel(soup, &grid, of).map(|_| ()).expect_err(words).to_string();
        assert!(said.contains(words) && said.starts_with("the mesh: "), "{words:?}: {said}");
    }
}

#[test]
fn malformed_files_are_refused_with_what_is_wrong() {
    let folder = folder("malformed");
    let good = glb(&cube(0.5), r#"[{"mesh":0}]"#);
    let text = |from: &str, to: &str| {
        // Of the same length, so that the chunks stay where they are.
        let to = format!("{to:width$}", width = from.len());
        let (from, to) = (from.as_bytes(), to.as_bytes());
        let at = good.windows(from.len()).position(|w| w == from).expect("it is there");
        [&good[..at], to, &good[at + from.len()..]].concat()
    };
    let circle = glb(&cube(0.5), r#"[{"mesh":0,"children":[0]}]"#);
    let mut beyond = cube(0.5);
    beyond.1[3] = [0, 1, 900];
    for (name, bytes, words) in [
        ("a.obj", b"v 0 0 0\nv 1 0\n".to_vec(), "line 2: a point has 2 numbers"),
        ("b.obj", b"v 0 0 zero\n".to_vec(), "line 1: 'zero' is not a number"),
        ("c.obj", b"v 0 0 0\nf 1 1 2\n".to_vec(), "line 2: '2' names none of the 1 points"),
        ("d.obj", b"v 0 0 0\nf 1 0 1\n".to_vec(), "line 2: '0' names none"),
        ("e.obj", b"v 0 0 0\nf -1 -2 1\n".to_vec(), "line 2: '-2' names none"),
        ("f.obj", b"v 0 0 0\nf 1 1\n".to_vec(), "line 2: a face has 2 corners"),
        ("g.obj", b"v nan 0 0\nf 1 1 1\n".to_vec(), "point 0 is [NaN"),
        ("h.obj", b"\xff\xfe\0\0".to_vec(), "no triangle"),
        ("i.stl", b"solid".to_vec(), ".obj, .glb or .gltf"),
        ("j.glb", good[..70].to_vec(), "j.glb"),
        ("k.glb", b"glTF".to_vec(), "k.glb"),
        ("l.gltf", b"{}".to_vec(), "l.gltf"),
        ("m.glb", text(r#""count":36"#, r#""count":99"#), "reaches beyond its buffer"),
        ("n.glb", text(r#""count":8"#, r#""count":0"#), "index 0 is out of range of 0 points"),
        ("o.glb", text("5123", "5126"), "of a wrong type"),
        ("p.glb", text(r#""byteOffset":96"#, r#""byteOffset":98"#), "reaches beyond"),
        ("q.glb", circle, "in a circle"),
        ("r.glb", glb(&beyond, r#"[{"mesh":0}]"#), "index 900 is out of range of 8 points"),
        ("s.glb", glb(&cube(0.5), r#"[{"mesh":7}]"#), "s.glb"),
        ("t.glb", glb(&(vec![Vec3::INFINITY], vec![[0; 3]]), r#"[{"mesh":0}]"#), "point 0 is"),
    ] {
        let path = folder.join(name);
        fs::write(&path, bytes).unwrap();
        let said = Mesh::read(&path).map(|_| ()).expect_err(name).to_string();
        assert!(said.contains(words) && said.contains(name), "{name}: {said}");
    }
    let missing = Mesh::read(folder.join("none.obj")).unwrap_err();
    assert!(matches!(missing.fault, MeshFault::Unreadable(_)), "{missing}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_scene_file_names_shapes_and_meshes() {
    let folder = folder("scene");
    // The box of the base scene: 0.192 m wide and deep, its top at 0.
    let small = |p: &Vec3| 0.2 * (*p - Vec3::Y * 0.25);
    let (points, triangles) = cauldron(0.06, 0.3);
    let pot = (points.iter().map(small).collect::<Vec<_>>(), triangles);
    fs::write(folder.join("pot.obj"), obj(&pot)).unwrap();
    let read = |keys: &str| {
        let path = folder.join("soup.toml");
        scenes::read(path.to_str().unwrap(), &format!("\n[vessel]\n{keys}\n"))
    };
    let scene = read("mesh = \"pot.obj\"\ninside_m = [0.0, -0.05, 0.0]").unwrap();
    let volume_m3 = Cut::new(&scene.grid, &scene.vessel).volume_m3() as f32;
    assert!((volume_m3 / (0.008 * CAULDRON_M3) - 1.0).abs() < 0.01, "{volume_m3}");
    let deep = read("shape = \"bowl\"\ncentre_m = [0.0, -0.05, 0.0]").unwrap();
    assert!(matches!(deep.vessel, Vessel::Bowl { radius_m, .. } if radius_m == 0.09));
    let tube = read("shape = \"cylinder\"\naxis = [0.0, 1.0, 0.2]").unwrap();
    assert!(matches!(tube.vessel, Vessel::Cylinder { radius_m, .. } if radius_m == 0.09));
    for (keys, known) in [
        ("shape = \"pot\"", "wave"),
        ("shape = \"cylinder\"", "wave"),
        ("shape = \"cylinder\"\naxis = [0.0, 1.0, 0.2]", "spring"),
        ("mesh = \"pot.obj\"\ninside_m = [0.0, -0.05, 0.0]", "spring"),
    ] {
        let choose = |name: &str| {
            let scene = read(&format!("{keys}\n[surface]\nmodel = \"{name}\""));
            let chosen = scene.map(|s| surface::choose(name, &s.vessel, &s.grid).map(|r| r.name));
            chosen.map_err(|e| e.to_string())
        };
        assert!(matches!(choose("auto"), Ok(Ok(name)) if name == known), "{keys}");
        assert!(matches!(choose("spring"), Ok(Ok("spring"))), "{keys}");
        let refused = choose("wave").err();
        let is_named = refused.as_ref().is_some_and(|why| why.contains("surface.model = wave"));
        assert_eq!(is_named, known == "spring", "{keys}: {refused:?}");
    }
    for (keys, line, words) in [
        ("shape = \"bowl\"", 3, "must reach up to the rest surface"),
        ("shape = \"urn\"", 3, "vessel.shape = \"urn\": must be box, pot, bowl or cylinder"),
        ("shape = \"pot\"\naxis = [0.0, 1.0, 0.0]", 4, "vessel.axis"),
        ("shape = \"cylinder\"\naxis = [0.0, 0.0, 0.0]", 4, "vessel.axis = 0"),
        ("radius_m = 0.08\ninside_m = [0.0, 0.0, 0.0]", 4, "vessel.inside_m"),
        ("mesh = \"pot.obj\"\nradius_m = 0.08", 3, "a mesh goes without"),
        ("mesh = \"pan.obj\"", 3, "pan.obj\": cannot be read"),
        ("mesh = \"pot.obj\"\ninside_m = [0.0, 0.5, 0.0]", 4, "not in the grid's box"),
        ("mesh = \"pot.obj\"\ninside_m = [0.09, -0.01, 0.0]", 4, "in the wall"),
        ("shape = \"bowl\"\nradius_m = 0.1\n[probe]\nradius_m = 0.09", 6, "probe.radius_m"),
    ] {
        let said = read(keys).map(|_| ()).expect_err(words).to_string();
        assert!(said.contains(&format!("soup.toml, line {line}: ")), "{keys}: {said}");
        assert!(said.contains(words) && !said.contains('\n'), "{keys}: {said}");
    }
    fs::remove_dir_all(folder).unwrap();
}
