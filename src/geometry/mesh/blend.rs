//! A mesh between two meshes with the same triangles.

use super::corners::Corners;
use super::{ArrayValues, DataArray, MeshData};
use crate::base::color::Rgb;
use crate::base::math::{DVec2, DVec3};
use crate::base::time::Fraction;
use crate::track::Animate;
use glam::Vec3;

/// The mesh at the fraction `s` from `a` (0) to `b` (1), which have as many vertices and the same triangles. Everything
/// that both have alike is interpolated linearly, numbers in f64; the rest is that of `a`. Normals that only one of them
/// has are left out.
pub fn blended(a: &MeshData, b: &MeshData, s: Fraction) -> MeshData {
    let uv = |a: &DVec2, b: &DVec2| DVec2::new(f64::mix(&a.x, &b.x, s), f64::mix(&a.y, &b.y, s));
    let normal = |a: &Vec3, b: &Vec3| DVec3::mix(&unit(a), &unit(b), s).as_vec3();
    let normals = a.normals.as_ref().zip(b.normals.as_ref());
    let uvs = a.uvs.as_ref().map(|own| match &b.uvs {
        Some(other) => between(own, other, uv).unwrap_or_else(|| own.clone()),
        None => own.clone(),
    });
    MeshData {
        positions: mixed(&a.positions, &b.positions, |a, b| DVec3::mix(a, b, s)),
        triangles: a.triangles.clone(),
        normals: normals.map(|(a, b)| between(a, b, normal).unwrap_or_else(|| a.clone())),
        uvs,
        colors: match a.colors.len() == b.colors.len() {
            true => mixed(&a.colors, &b.colors, |a, b| Rgb::mix(a, b, s)),
            false => a.colors.clone(),
        },
        slots: a.slots.clone(),
        materials: a.materials.clone(),
        arrays: a.arrays.iter().map(|array| array_between(array, &b.arrays, s)).collect(),
    }
}

/// Files may hold normals of any length.
fn unit(normal: &Vec3) -> DVec3 {
    normal.as_dvec3().normalize_or_zero()
}

/// Pairs of values, mixed. The lists are equally long.
fn mixed<T>(a: &[T], b: &[T], mix: impl Fn(&T, &T) -> T) -> Vec<T> {
    a.iter().zip(b).map(|(a, b)| mix(a, b)).collect()
}

/// Values at corners, mixed; none if the corners share their values differently.
fn between<T: Copy + Send>(a: &Corners<T>, b: &Corners<T>, mix: impl Fn(&T, &T) -> T) -> Option<Corners<T>> {
    a.has_indices_of(b).then(|| a.with_values(mixed(a.values(), b.values(), mix)))
}

/// An array mixed with the array of the same name and kind among others; itself if there is none.
fn array_between(array: &DataArray, others: &[DataArray], s: Fraction) -> DataArray {
    let fits = |other: &&DataArray| {
        (&other.name, other.centering, other.components) == (&array.name, array.centering, array.components)
            && other.values.len() == array.values.len()
    };
    let Some(other) = others.iter().find(fits) else { return array.clone() };
    let values = (0..array.values.len()).map(|at| f64::mix(&array.values.get(at), &other.values.get(at), s));
    DataArray { values: ArrayValues::F64(values.collect()), ..array.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::{Centering, Component};

    fn mesh(shift: f64, normal: Vec3) -> MeshData {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|corner| corner + DVec3::Z * shift).to_vec();
        let array = DataArray {
            name: "t".to_owned(),
            centering: Centering::Points,
            components: 1,
            values: vec![shift, 2.0 * shift, f64::NAN].into(),
        };
        MeshData {
            positions,
            triangles: vec![[0, 1, 2]],
            normals: Some(Corners::per_vertex(vec![normal; 3])),
            uvs: Some(Corners::per_vertex(vec![DVec2::splat(shift); 3])),
            colors: vec![Rgb::splat(shift as f32); 3],
            arrays: vec![array],
            ..MeshData::default()
        }
    }

    #[test]
    fn everything_is_interpolated() {
        let (a, b) = (mesh(1.0, Vec3::X), mesh(5.0, 8.0 * Vec3::Y));
        let half = blended(&a, &b, Fraction { num: 1.0, den: 2.0 });
        assert_eq!(half.positions[1], DVec3::new(1.0, 0.0, 3.0));
        assert_eq!(half.colors[0], Rgb::splat(3.0));
        assert_eq!(half.uvs, Some(Corners::per_vertex(vec![DVec2::splat(3.0); 3])));
        // Not drawn to the longer one.
        assert_eq!(half.normals.as_ref().expect("normals").values()[0], Vec3::new(0.5, 0.5, 0.0));
        let [t, u, v] = [0, 1, 2].map(|vertex| half.arrays[0].value(vertex, Component::Whole));
        assert!(t == 3.0 && u == 6.0 && v.is_nan());
        assert_eq!(blended(&a, &b, Fraction { num: 0.0, den: 1.0 }).positions, a.positions);
    }

    #[test]
    fn what_only_one_has_stays() {
        let (a, mut b) = (mesh(1.0, Vec3::X), mesh(5.0, Vec3::Y));
        (b.uvs, b.normals, b.arrays) = (None, None, Vec::new());
        b.colors.clear();
        let half = blended(&a, &b, Fraction { num: 1.0, den: 2.0 });
        assert_eq!((&half.uvs, &half.colors), (&a.uvs, &a.colors));
        assert_eq!(half.arrays[0].value(0, Component::Whole), 1.0);
        assert_eq!(half.normals, None);
    }
}
