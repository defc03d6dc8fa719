//! Where a camera stands and how it is mounted, from the clicks of a document's frames.
//!
//! ```sh
//! cargo run --example estimate_base -- [DOC]
//! ```

use std::env;
use std::error::Error;
use std::path::PathBuf;
use touchline::calibrate::BaseProblem;
use touchline::progress::Progress;
use touchline::solve::base::BaseOptions;
use touchline::store::read;

fn main() -> Result<(), Box<dyn Error>> {
    let path = env::args()
        .nth(1)
        .map_or_else(|| PathBuf::from("projects/demo"), PathBuf::from);
    let (location, mut document, _) = read(&path)?;
    let camera = document
        .cameras
        .first()
        .ok_or("the document has no camera")?
        .id
        .clone();

    let problem = BaseProblem::from_document(document.at(location.folder()), &camera)?;
    let found = problem.estimate(&document, &BaseOptions::default(), &Progress::default())?;

    let base = &found.estimate.base;
    println!(
        "{} clicks of camera {:?}",
        problem.click_count(),
        camera.as_str()
    );
    let (at, sigma) = (base.position_m, base.sigma.position_m);
    println!(
        "position ({:.2}, {:.2}, {:.2}) ± ({:.2}, {:.2}, {:.2}) m",
        at.x, at.y, at.z, sigma.x, sigma.y, sigma.z
    );
    println!("clicks lie {:.2} px off (median)", found.estimate.median_px);
    // The document takes the base over; `store::write_document` would keep it.
    found.write_camera(&mut document);
    Ok(())
}
