// Traces a scene that is built by hand: without a file, a timeline or a world of entities.

use kinora::{
    Bvh, Camera, DAffine3, DVec3, Finish, Geometry, LayerId, Light, Lobes, Material, MaterialBinding, Plane,
    ProgressMeter, Projection, Quality, Rgb, Scene, Shading, Shape, Source, Sphere, TraceSettings, Weights,
    look_at, trace,
};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // Shapes with their places. A material is a number in the list below.
    let mut geometry = Geometry::default();
    let clay = Finish::Material(MaterialBinding::One(0));
    let ball = Sphere { center: DVec3::ZERO, radius: 1.0 };
    geometry.push(&Shape::Sphere(ball), DAffine3::from_translation(DVec3::Y), clay);
    geometry.push(&Shape::Plane(Plane { point: DVec3::ZERO, normal: DVec3::Y }), DAffine3::IDENTITY, clay);

    let diffuse = Rgb::new(0.8, 0.4, 0.2);
    let material = Material { lobes: Lobes { diffuse, ..Lobes::default() }, ..Material::default() };
    let sun = Light {
        source: Source::Directional { to_light: DVec3::Y },
        radiance: Rgb::ONE,
        shadows: true,
        layer: LayerId::CONSTANT,
    };
    let shading = Shading { materials: vec![material], lights: vec![sun], ..Shading::default() };

    // From straight above. Half the picture's height at distance 1 is the tangent of half the field of view.
    let camera = Camera {
        position: DVec3::new(0.0, 9.0, 0.0),
        basis: look_at(DVec3::new(0.0, 9.0, 0.0), DVec3::ZERO, DVec3::Z)
            .ok_or("eye and target are the same point")?,
        projection: Projection::Perspective { half_height: 0.25 },
        lens: None,
    };
    let weights = Weights(vec![Rgb::ONE]);
    let scene = Scene { geometry: &geometry, shading: &shading, weights: &weights, camera: &camera };
    let settings = TraceSettings::new((65, 65), Quality::default());
    let (film, counts) = trace(&scene, &Bvh::build(&geometry), &settings, &ProgressMeter::default());

    // The corner shows the floor, which faces the sun: its radiance is the diffuse reflectance.
    assert_eq!(film.radiance_at(0), diffuse);
    // The sun meets the ball's outline at a right angle there, so it is darker than the floor.
    let center = 32 * 65 + 32;
    assert!(film.radiance_at(center).x <= diffuse.x && film.radiance_at(center - 8).x < diffuse.x);
    assert_eq!(counts.rays.camera, 65 * 65 * 4);
    Ok(())
}
