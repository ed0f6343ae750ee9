//! Checks of meshes, removal of triangles, and smooth normals.

use super::*;
use crate::testing::Random;

fn square() -> MeshData {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
    MeshData { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..MeshData::default() }
}

#[test]
fn parts_must_fit_together() {
    let fault = |change: &dyn Fn(&mut MeshData)| {
        let mut parts = square();
        change(&mut parts);
        TriangleMesh::new(parts).expect_err("a fault").to_string()
    };
    assert_eq!(
        fault(&|parts| parts.triangles[1] = [0, 1, 4]),
        "face 1: there is no vertex 4; the mesh has 4"
    );
    assert_eq!(
        fault(&|parts| parts.positions[2].z = f64::NAN),
        "vertex 2: the vertex has z = NaN; coordinates are finite and at most 1e30"
    );
    assert_eq!(fault(&|parts| parts.triangles.clear()), "it has no triangles");
    assert_eq!(fault(&|parts| parts.triangles = vec![[0, 0, 1]]), "none of its triangles has an area");
    assert!(fault(&|parts| parts.colors = vec![Rgb::ONE]).contains("a colour for every vertex"));
    assert!(fault(&|parts| parts.slots = vec![0]).contains("a slot for every triangle"));
}

#[test]
fn what_is_left_out_takes_its_attributes_with_it() {
    let mut parts = square();
    parts.triangles.insert(0, [3, 3, 0]);
    parts.slots = vec![7, 8, NO_MATERIAL];
    let uvs = vec![DVec2::ZERO, DVec2::ONE];
    parts.uvs = Some(Corners::indexed(uvs, vec![[0; 3], [1; 3], [0; 3]], &parts.triangles));
    let mesh = TriangleMesh::new(parts).expect("a mesh");
    assert_eq!((mesh.skipped, mesh.triangles().len()), (1, 2));
    assert_eq!((mesh.material_of(0), mesh.material_of(1), mesh.material_of(2)), (Some(8), None, None));
    assert_eq!(mesh.corner_uvs(0), Some([DVec2::ONE; 3]));
    assert_eq!(mesh.corner_uvs(1), Some([DVec2::ZERO; 3]));
}

/// The tree of a mesh that moved is the old one while it is good, and a new one otherwise.
#[test]
fn trees_are_refitted_while_they_are_good() {
    let rest = TriangleMesh::new(generate::displaced_sphere(4, 7)).expect("a mesh");
    let moved = |by: &mut dyn FnMut(DVec3) -> DVec3| {
        let mut data = generate::displaced_sphere(4, 7);
        data.positions.iter_mut().for_each(|position| *position = by(*position));
        data
    };
    let far = moved(&mut |position| 1e6 + 3.0 * position);
    let after = TriangleMesh::after(far.clone(), Some(&rest)).expect("a mesh");
    assert_eq!(after.tree.refits(), 1);
    let leaves =
        |mesh: &TriangleMesh| mesh.packets.iter().map(|packet| packet.parts().to_vec()).collect::<Vec<_>>();
    assert_eq!(leaves(&after), leaves(&rest));
    // It has the boxes that it would have if it had been built.
    assert!((after.tree.cost() / TriangleMesh::new(far).expect("a mesh").tree.cost() - 1.0).abs() < 0.05);

    let mut random = Random(4);
    let shuffled = moved(&mut |_| random.point(1.0));
    let after = TriangleMesh::after(shuffled.clone(), Some(&rest)).expect("a mesh");
    assert_eq!(after.tree.refits(), 0);
    assert_eq!(leaves(&after), leaves(&TriangleMesh::new(shuffled).expect("a mesh")));

    // What lies far away does not keep a tree of others for ever.
    let mut last = rest;
    let refits: Vec<u32> = (1..=40)
        .map(|step| {
            let mut data = moved(&mut |position| position + 1e-3 * random.point(1.0));
            data.positions[0] *= 2.0 * f64::from(step);
            last = TriangleMesh::after(data, Some(&last)).expect("a mesh");
            last.tree.refits()
        })
        .collect();
    assert!(refits.contains(&0) && refits.iter().any(|refits| *refits > 0), "{refits:?}");

    // Other triangles have another tree.
    let mut fewer = generate::displaced_sphere(4, 7);
    fewer.triangles.pop();
    let after = TriangleMesh::after(fewer, Some(&last)).expect("a mesh");
    let mut parts = leaves(&after).concat();
    parts.sort_unstable();
    assert_eq!(parts, (0..after.triangles().len() as u32).collect::<Vec<_>>());
}

/// Whatever the triangulation of a cube's faces, the normals of its corners point away from its centre.
#[test]
fn smooth_normals_do_not_depend_on_the_cut() {
    let mut random = Random(8);
    let corner =
        |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) - DVec3::splat(0.5);
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    for _ in 0..20 {
        let cut = |side: [u32; 4]| {
            let first = (random.unit() * 4.0) as usize;
            let at = |i: usize| side[(first + i) % 4];
            [[at(0), at(1), at(2)], [at(0), at(2), at(3)]]
        };
        let triangles: Vec<_> = sides.into_iter().flat_map(cut).collect();
        let positions = (0..8).map(corner).collect();
        let mesh =
            TriangleMesh::new(MeshData { positions, triangles, ..MeshData::default() }).expect("a cube");
        for (position, normal) in mesh.positions().iter().zip(mesh.smooth_normals()) {
            assert!((position.normalize() - normal.as_dvec3()).length() < 1e-7, "{position} {normal}");
        }
    }
}

/// Triangles that share positions but no indices are smooth across their edges too.
#[test]
fn equal_positions_share_their_normal() {
    let sphere = generate::icosphere(2);
    let positions: Vec<_> =
        sphere.triangles.iter().flatten().map(|vertex| sphere.positions[*vertex as usize]).collect();
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = TriangleMesh::new(MeshData { positions, triangles, ..MeshData::default() }).expect("a sphere");
    for (position, normal) in mesh.positions().iter().zip(mesh.smooth_normals()) {
        assert!(position.dot(normal.as_dvec3()) > 0.99);
    }
}

#[test]
fn icospheres_are_closed_and_turned_outwards() {
    for subdivisions in 0..3 {
        let MeshData { positions, triangles, .. } = generate::icosphere(subdivisions);
        assert_eq!(triangles.len(), 20 << (2 * subdivisions));
        assert_eq!(positions.len(), triangles.len() / 2 + 2, "Euler");
        for triangle in triangles {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
        }
    }
    let one = generate::displaced_sphere(3, 1);
    assert_eq!(one, generate::displaced_sphere(3, 1));
    assert_ne!(one, generate::displaced_sphere(3, 2));
    assert!(one.positions.iter().all(|p| (0.6..1.4).contains(&p.length())));
}

/// Ranges of data are those of what is visible.
#[test]
fn vertices_that_no_triangle_uses_have_no_data() {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::splat(9.0), DVec3::X * 2.0];
    let values = vec![3.0, 1.0, 2.0, 1e6, -7.0].into();
    let array = DataArray { name: "q".to_owned(), centering: Centering::Points, components: 1, values };
    // The second triangle has no area.
    let triangles = vec![[0, 1, 2], [0, 1, 4]];
    let data = MeshData { positions, triangles, arrays: vec![array], ..MeshData::default() };
    let mesh = TriangleMesh::new(data).expect("a mesh");
    let key = ArrayKey::whole("q".to_owned());
    assert_eq!(mesh.array_range(&key, |_| true), Some([1.0, 3.0]));
    assert_eq!(mesh.array_range(&key, |value| value > 1.0), Some([2.0, 3.0]));
}
