//! Scenes in which something lies where formulas divide by zero: lights on surfaces, eyes within things, sizes and
//! settings at the ends of their ranges. No sample may be other than light, by either integrator.

use crate::support::shoot_counting;
use kinora::base::stats::Dropped;

/// A scene of its own camera, lights and objects.
#[track_caller]
fn is_all_light(name: &str, fields: &str) {
    for integrator in ["Whitted", "Path(roulette: Off)"] {
        let text = format!(
            "(output: (size: (24, 18)), quality: (integrator: {integrator}, samples: 4, antialias: 2, bounces: 6), {fields})"
        );
        let (film, dropped) = shoot_counting(&text);
        assert_eq!(dropped, Dropped::default(), "{name} by {integrator}");
        let fine = |pixel: kinora::base::color::Rgb| pixel.is_finite() && pixel.min_element() >= 0.0;
        assert!(film.radiance().all(fine), "{name} by {integrator}");
    }
}

const EYE: &str = "camera: (position: (0, 2, 6), target: (0, 0.5, 0))";
const SUN: &str = "lights: { \"sun\": Directional(direction: (-1, -2, -1)) }";
const FLOOR: &str = "\"floor\": (shape: Plane(), material: (mirror: 0.2, specular: 0.4))";

#[test]
fn lights_in_odd_places() {
    for (name, light) in [
        ("on the floor", "Point(position: (0, 0, 0))"),
        ("on the ball", "Point(position: (0, 2, 0))"),
        ("in the middle of the ball", "Point(position: (0, 1, 0))"),
        ("in the eye", "Point(position: (0, 2, 6))"),
        ("next to the floor", "Point(position: (0, 1e-300, 0), attenuation: (quadratic: 1))"),
        (
            "with a falloff, on the floor",
            "Point(position: (0.3, 0, 1), attenuation: (constant: 0, quadratic: 1))",
        ),
        ("far away", "Point(position: (1e9, 1e9, 1e9))"),
        ("level", "Directional(direction: (1, 0, 0))"),
        ("upwards", "Directional(direction: (0, 1, 0))"),
        ("hardly a direction", "Directional(direction: (1e-20, -1e-20, 0))"),
        ("a narrow spot", "Spot(position: (0, 5, 0), target: (0, 0, 0), angle: 0.001)"),
        ("a spot on what it lights", "Spot(position: (0, 0, 0), target: (0, 1, 0), angle: 60)"),
        ("a ball around all", "Sphere(center: (0, 0, 0), radius: 100)"),
        ("a ball around the eye", "Sphere(center: (0, 2, 6), radius: 0.5)"),
        ("a ball that touches the floor", "Sphere(center: (2, 0.5, 0), radius: 0.5)"),
        ("a speck", "Sphere(center: (2, 1, 0), radius: 1e-9)"),
        ("a rectangle in the floor", "Rectangle(corner: (1, 0, 1), u: (1, 0, 0), v: (0, 0, 1))"),
        ("a rectangle seen from its edge", "Rectangle(corner: (-1, 2, 0), u: (2, 0, 0), v: (0, 0, 2))"),
    ] {
        let objects = format!(
            "objects: {{ {FLOOR}, \"ball\": (shape: Sphere(center: (0, 1, 0)), material: (specular: 1)) }}"
        );
        is_all_light(name, &format!("{EYE}, lights: {{ \"light\": {light} }}, {objects}"));
    }
}

#[test]
fn cameras_in_odd_places() {
    for (name, camera) in [
        ("on the floor", "(position: (0, 0, 6), target: (0, 0, 0))"),
        ("on the ball", "(position: (0, 1, 1), target: (0, 1, 0))"),
        ("in the middle of the ball", "(position: (0, 1, 0), target: (0, 1, -1))"),
        ("straight down", "(position: (0, 9, 0), target: (0, 0, 0))"),
        ("straight up", "(position: (0, 3, 0), target: (0, 9, 0))"),
        ("in the tip of a cone", "(position: (3, 1, 0), target: (0, 0, 0))"),
        ("in the corner of a box", "(position: (-3, 1, 1), target: (0, 0, 0))"),
        ("far away", "(position: (1e9, 1e9, 1e9), target: (0, 0, 0), projection: Perspective(fov: 1e-5))"),
        ("very wide", "(position: (0, 2, 6), target: (0, 0, 0), projection: Perspective(fov: 179.9))"),
        ("very narrow", "(position: (0, 2, 6), target: (0, 1, 1), projection: Perspective(fov: 1e-6))"),
        (
            "parallel, tiny",
            "(position: (0, 2, 6), target: (0, 1, 1), projection: Orthographic(height: 1e-9))",
        ),
        ("parallel, huge", "(position: (0, 2, 6), target: (0, 1, 1), projection: Orthographic(height: 1e9))"),
        ("a lens as wide as the scene", "(position: (0, 2, 6), target: (0, 1, 1), aperture: 5, focus: 1e-6)"),
    ] {
        let objects = format!(
            "objects: {{ {FLOOR}, \"ball\": (shape: Sphere(center: (0, 1, 0)), material: Dielectric()),
            \"tip\": (shape: Cone(), translation: (3, 0, 0)), \"box\": (shape: Box(min: (-4, 0, 0), max: (-3, 1, 1))) }}"
        );
        is_all_light(name, &format!("camera: {camera}, {SUN}, background: Gradient(), {objects}"));
    }
}

#[test]
fn sizes_at_the_ends_of_their_ranges() {
    for (name, object) in [
        ("a speck", "shape: Sphere(radius: 1e-6)"),
        ("a planet", "shape: Sphere(center: (0, -6371000, 0), radius: 6371000)"),
        ("a wire", "shape: Cylinder(from: (-5, 1, 0), to: (5, 1, 0), radius: 1e-7)"),
        ("a coin", "shape: Cylinder(from: (0, 1, 0), to: (0, 1.0000001, 0), radius: 1)"),
        ("a needle", "shape: Cone(radius: 1e-6), scale: (1, 3, 1)"),
        ("a flat cone", "shape: Cone(), scale: (1, 1e-9, 1)"),
        ("a torus without a hole", "shape: Torus(major: 1, minor: 0.9999999)"),
        ("a ring of wire", "shape: Torus(major: 1, minor: 1e-9)"),
        ("a sheet", "shape: Box(min: (-1, 1, -1), max: (1, 1.000000001, 1))"),
        ("an egg as flat as a sheet", "shape: Sphere(), scale: (1, 1e-9, 1)"),
        ("a splinter", "shape: Triangle(a: (-3, 0, 0), b: (3, 0, 0), c: (0, 1e-9, 0))"),
        ("turned inside out", "shape: Sphere(), scale: (-1, 1, 1), rotation: Euler(x: 90, y: 180)"),
        ("far away and tiny", "shape: Torus(), translation: (1e6, 1e6, 1e6), scale: 1e-6"),
    ] {
        for material in ["(specular: 1, mirror: 0.5)", "Dielectric()", "(mirror: 1, fuzz: 1)"] {
            let objects = format!("objects: {{ {FLOOR}, \"odd\": ({object}, material: {material}) }}");
            is_all_light(name, &format!("{EYE}, {SUN}, background: 0.5, {objects}"));
        }
    }
}

#[test]
fn materials_and_air_at_the_ends_of_their_ranges() {
    for (name, material) in [
        ("no boundary", "Dielectric(ior: 1)"),
        ("hardly a boundary", "Dielectric(ior: 1.0000000001)"),
        ("a strong boundary", "Dielectric(ior: 100)"),
        ("thinner than air", "Dielectric(ior: 0.01)"),
        ("all but polished", "MetallicRoughness(metallic: 1, roughness: 1e-6)"),
        ("as rough as can be", "MetallicRoughness(metallic: 1, roughness: 1)"),
        ("a sharp highlight", "(specular: 1, shininess: 1000000)"),
        ("no exponent", "(specular: 1, shininess: 0)"),
        ("a fine pattern", "(color: Checker(scale: 1e-6))"),
        ("a coarse pattern", "(color: Checker(scale: 1e9))"),
    ] {
        let objects = format!(
            "objects: {{ {FLOOR}, \"ball\": (shape: Sphere(center: (0, 1, 0)), material: {material}) }}"
        );
        is_all_light(name, &format!("{EYE}, {SUN}, background: Gradient(), {objects}"));
    }
    for (name, fog) in [
        ("thick", "(density: 1e9)"),
        ("thin", "(density: 1e-300)"),
        ("a thin layer", "(density: 1, falloff: (height: 1e-9))"),
        ("endless", "(density: 1, falloff: (height: 1e9))"),
        ("far below", "(density: 1, falloff: (base: -1e9, height: 1))"),
        ("far above", "(density: 1, falloff: (base: 1e9, height: 1))"),
    ] {
        is_all_light(name, &format!("{EYE}, {SUN}, background: 0.5, fog: {fog}, objects: {{ {FLOOR} }}"));
    }
}
