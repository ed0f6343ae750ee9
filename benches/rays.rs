//! Ray throughput on one thread, over scenes and rays in files:
//!
//! ```text
//! cargo bench --bench rays -- DIR [--json FILE]
//! ```
//!
//! For each `NAME.mesh` in DIR, the rays of `NAME.primary.rays` and `NAME.bounce.rays` are traced for the nearest hit and
//! those of `NAME.shadow.rays` for any, one by one and, where neighbours go the same way, in bundles of eight, which are
//! given as rows of numbers. Both are asked for as renders do, by code that is on its SIMD level already. Times are those of the thread's own clock, the median of a few passes after one to warm up. All rays of `NAME.edge.rays`, if there
//! are any, should hit something: those that miss are counted, over all four ways to trace them. Meshes are built on all
//! threads (`RAYON_NUM_THREADS` limits them); times are medians as well. Hits are written to `NAME.SET.ours.hits`. Numbers
//! in the files are little-endian:
//!
//! - `.mesh`: `KMSH`, u32 vertices, u32 triangles, three f32 per vertex, three u32 per triangle
//! - `.rays`: `KRAY`, u32 count, then origin, tmin, direction, tmax per ray, eight f32
//! - `.hits`: `KHIT`, u32 count, then a u32 triangle (0xffffffff for none) and its f32 t per ray

use kinora::base::lanes::{Level, Mask as _, Row as _, SimdKernel, Single as _, Vec3, dispatch};
use kinora::base::math::{DVec3, LaneRay, Ray};
use kinora::geometry::bvh::{Stack, TraversalRay};
use kinora::geometry::mesh::{self, MeshData, Normals};
use kinora::geometry::shape::{Geometric as _, Mesh, PreparedRay, RayInterval, any_part_on, nearest_part_on};
use rustix::time::{ClockId, clock_gettime};
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::{Write as _, stdout};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Passes that count.
const PASSES: usize = 5;

/// How often a mesh is built.
const BUILDS: usize = 5;

const SETS: [&str; 3] = ["primary", "bounce", "shadow"];

const NONE: u32 = u32::MAX;

/// A ray as the files have it.
struct Record {
    origin: [f32; 3],
    direction: [f32; 3],
    t_max: f32,
}

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut folder, mut json) = (None, None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--json" => json = arguments.next(),
            _ => folder = Some(PathBuf::from(argument)),
        }
    }
    // `cargo bench` alone runs every bench; this one needs its files.
    let Some(folder) = folder else {
        return Ok(writeln!(stdout(), "rays: give a folder of scenes and rays")?);
    };
    let mut meshes: Vec<_> = fs::read_dir(&folder)?.map(|entry| Ok(entry?.path())).collect::<Outcome<_>>()?;
    meshes.retain(|path| path.extension().is_some_and(|extension| extension == "mesh"));
    meshes.sort();
    let mut report = String::new();
    for path in &meshes {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let (mesh, [wall, cpu]) = load(path)?;
        let count = mesh.mesh.triangles().len();
        writeln!(stdout(), "{name}: {count} triangles, built in {wall:.1} ms, {cpu:.1} ms of processors")?;
        let mut sets = String::new();
        for set in SETS {
            let rays = path.with_extension(format!("{set}.rays"));
            let rays = read_rays(&rays)?;
            let any = set == "shadow";
            let (rate, hits) = timed(rays.len(), |hits| trace(&mesh, &rays, any, hits));
            fs::write(path.with_extension(format!("{set}.ours.hits")), written(&hits))?;
            write!(stdout(), "  {set:8} {rate:7.3} Mray/s")?;
            write!(sets, "{}\"{set}\": {{\"single\": {rate}", if sets.is_empty() { "" } else { ", " })?;
            if set != "bounce" {
                let bundles = bundles(&rays);
                let (rate, together) = timed(rays.len(), |hits| trace_bundles(&mesh, &bundles, any, hits));
                if together != hits {
                    return Err(format!("{name}, {set}: rays in bundles hit something else").into());
                }
                write!(stdout(), ", {rate:7.3} in bundles of eight")?;
                write!(sets, ", \"packet\": {rate}")?;
            }
            writeln!(stdout())?;
            sets.push('}');
        }
        let edges = path.with_extension("edge.rays");
        if edges.exists() {
            let lost = lost(&mesh, &read_rays(&edges)?);
            writeln!(stdout(), "  edge     {lost} rays miss")?;
            write!(sets, ", \"edge_misses\": {{\"single\": {lost}}}")?;
        }
        let threads = rayon::current_num_threads();
        let build = format!("\"single_{threads}t\": {wall}, \"single_{threads}t_cpu\": {cpu}");
        let comma = if report.is_empty() { "" } else { ", " };
        write!(report, "{comma}\"{name}\": {{{sets}, \"build_ms\": {{{build}}}}}")?;
    }
    match json {
        Some(file) => Ok(fs::write(file, format!("{{{report}}}\n"))?),
        None => Ok(()),
    }
}

/// Of this thread.
fn seconds() -> f64 {
    seconds_by(ClockId::ThreadCPUTime)
}

fn seconds_by(clock: ClockId) -> f64 {
    let time = clock_gettime(clock);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

impl Record {
    fn ray(&self) -> Ray {
        let vector = |[x, y, z]: [f32; 3]| DVec3::new(x.into(), y.into(), z.into());
        Ray { origin: vector(self.origin), direction: vector(self.direction) }
    }
}

/// A triangle, or none, and where it is hit.
type Found = (u32, f32);

fn trace(mesh: &Mesh, rays: &[Record], any: bool, hits: &mut [Found]) {
    dispatch(Singles { mesh, rays, any, hits });
}

/// Rays that are traced one by one.
struct Singles<'a> {
    mesh: &'a Mesh,
    rays: &'a [Record],
    any: bool,
    hits: &'a mut [Found],
}

impl SimdKernel for Singles<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        let Self { mesh, rays, any, hits } = self;
        let mut stack = Stack::default();
        for (ray, hit) in rays.iter().zip(hits) {
            let (probe, within) = (TraversalRay::new(ray.ray()), RayInterval::up_to(f64::from(ray.t_max)));
            *hit = (NONE, ray.t_max);
            if any {
                if any_part_on::<L>(mesh, &probe, within, Some(&mut stack)) {
                    hit.0 = 0;
                }
            } else if let Some(found) = nearest_part_on::<L>(mesh, &probe, within, Some(&mut stack)) {
                *hit = (found.part, found.t as f32);
            }
        }
    }
}

/// How many of rays that must hit something do not, one by one or in bundles, for the nearest hit or for any.
fn lost(mesh: &Mesh, rays: &[Record]) -> usize {
    let (mut lost, bundles) = (0, bundles(rays));
    for any in [false, true] {
        for together in [false, true] {
            let mut hits = vec![(NONE, 0.0); rays.len()];
            match together {
                true => trace_bundles(mesh, &bundles, any, &mut hits),
                false => trace(mesh, rays, any, &mut hits),
            }
            lost += hits.iter().filter(|(part, _)| *part == NONE).count();
        }
    }
    lost
}

fn trace_bundles(mesh: &Mesh, bundles: &[Rows], any: bool, hits: &mut [Found]) {
    dispatch(Bundles { mesh, bundles, any, hits });
}

/// Origins, directions and ends of eight rays.
type Rows = [[f32; 8]; 7];

/// Rays in rows, as a renderer has them. Lanes without a ray repeat the last one, and look at no part of it.
fn bundles(rays: &[Record]) -> Vec<Rows> {
    let rows = |rays: &[Record]| {
        let mut rows = [[0.0; 8]; 7];
        for lane in 0..8 {
            let Record { origin: [x, y, z], direction: [dx, dy, dz], t_max } = rays[lane.min(rays.len() - 1)];
            let end = if lane < rays.len() { t_max } else { 0.0 };
            for (row, number) in rows.iter_mut().zip([x, y, z, dx, dy, dz, end]) {
                row[lane] = number;
            }
        }
        rows
    };
    rays.chunks(8).map(rows).collect()
}

/// Rays that are traced eight at a time.
struct Bundles<'a> {
    mesh: &'a Mesh,
    bundles: &'a [Rows],
    any: bool,
    hits: &'a mut [Found],
}

impl SimdKernel for Bundles<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Level>(self) {
        for (rows, hits) in self.bundles.iter().zip(self.hits.chunks_mut(8)) {
            let [x, y, z, dx, dy, dz, end] = rows;
            let (origin, direction) = (vector::<L>(x, y, z), vector::<L>(dx, dy, dz));
            let ray = PreparedRay::new(LaneRay { origin, direction });
            let within = RayInterval::up_to(numbers::<L>(end));
            if self.any {
                let blocked = self.mesh.occludes(&ray, within).bits();
                for (lane, hit) in hits.iter_mut().enumerate() {
                    *hit = (if blocked >> lane & 1 == 1 { 0 } else { NONE }, end[lane]);
                }
            } else {
                let found = self.mesh.intersect(&ray, within);
                let (met, parts, t) = (found.is_hit().bits(), found.part.to_array(), found.t.to_array());
                for (lane, hit) in hits.iter_mut().enumerate() {
                    let is_met = met >> lane & 1 == 1;
                    *hit = if is_met { (parts[lane], t[lane] as f32) } else { (NONE, end[lane]) };
                }
            }
        }
    }
}

#[inline(always)]
fn vector<L: Level>(x: &[f32; 8], y: &[f32; 8], z: &[f32; 8]) -> Vec3<L::F64> {
    Vec3::new(numbers::<L>(x), numbers::<L>(y), numbers::<L>(z))
}

#[inline(always)]
fn numbers<L: Level>(row: &[f32; 8]) -> L::F64 {
    L::F32::from_array(*row).to_f64()
}

/// Millions of rays in a second, and the hits.
fn timed(rays: usize, trace: impl Fn(&mut [Found])) -> (f64, Vec<Found>) {
    let mut hits = vec![(NONE, 0.0); rays];
    let mut times = Vec::new();
    for _ in 0..=PASSES {
        let before = seconds();
        trace(&mut hits);
        times.push(seconds() - before);
    }
    // The first pass warms up.
    times.remove(0);
    times.sort_by(f64::total_cmp);
    (rays as f64 / times[PASSES / 2] * 1e-6, hits)
}

/// A mesh, and what it took to build: milliseconds, and those of all processors.
fn load(path: &Path) -> Outcome<(Mesh, [f64; 2])> {
    let bytes = fs::read(path)?;
    let words = words(&bytes, b"KMSH", path)?;
    let [vertices, triangles] = [words[0] as usize, words[1] as usize];
    let (positions, indices) = words[2..].split_at(3 * vertices);
    let float = |word: u32| f64::from(f32::from_bits(word));
    let parts = MeshData {
        positions: positions
            .chunks_exact(3)
            .map(|p| DVec3::new(float(p[0]), float(p[1]), float(p[2])))
            .collect(),
        triangles: indices[..3 * triangles].chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        ..MeshData::default()
    };
    let mut times = Vec::new();
    for _ in 1..BUILDS {
        times.push(build(parts.clone())?.1);
    }
    let (mesh, time) = build(parts)?;
    times.push(time);
    let median = |part: usize| {
        let mut times: Vec<f64> = times.iter().map(|time| time[part]).collect();
        times.sort_by(f64::total_cmp);
        times[BUILDS / 2]
    };
    Ok((Mesh::new(Arc::new(mesh), Normals::Flat), [median(0), median(1)]))
}

fn build(parts: MeshData) -> Outcome<(mesh::TriangleMesh, [f64; 2])> {
    let (start, before) = (Instant::now(), seconds_by(ClockId::ProcessCPUTime));
    let mesh = mesh::TriangleMesh::new(parts).map_err(|error| error.to_string())?;
    let cpu = seconds_by(ClockId::ProcessCPUTime) - before;
    Ok((mesh, [1e3 * start.elapsed().as_secs_f64(), 1e3 * cpu]))
}

fn read_rays(path: &Path) -> Outcome<Vec<Record>> {
    let bytes = fs::read(path)?;
    let words = words(&bytes, b"KRAY", path)?;
    let record = |ray: &[u32]| {
        let at = |place: usize| f32::from_bits(ray[place]);
        Record { origin: [at(0), at(1), at(2)], direction: [at(4), at(5), at(6)], t_max: at(7) }
    };
    Ok(words[1..].chunks_exact(8).map(record).collect())
}

/// The numbers behind a file's four letters.
fn words(bytes: &[u8], letters: &[u8; 4], path: &Path) -> Outcome<Vec<u32>> {
    let rest =
        bytes.strip_prefix(letters).ok_or_else(|| format!("{}: no such file", path.to_string_lossy()))?;
    Ok(rest.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
}

fn written(hits: &[(u32, f32)]) -> Vec<u8> {
    let mut bytes = b"KHIT".to_vec();
    bytes.extend((hits.len() as u32).to_le_bytes());
    for (part, t) in hits {
        bytes.extend(part.to_le_bytes());
        bytes.extend(t.to_le_bytes());
    }
    bytes
}
