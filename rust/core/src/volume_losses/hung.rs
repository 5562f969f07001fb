//! What joints of cut chains are not given though they move against what they hang on.

use crate::skinning::motions::Motions;
use crate::volume_losses::job::{Change, Job, find_job};

/// Hands the losses of joints that move like another bone on to those that move it against them; their sum stays.
pub(crate) fn hand_on(jobs: &[Job], motions: &Motions, changes: &mut [Change]) {
    let mut handed_on: Vec<(usize, f64)> = Vec::new();
    let handed = &motions.handed_on;
    for ((hung, &kept), parts) in motions.hung.iter().zip(&handed.kept).zip(&handed.parts).filter(|((_, kept), _)| **kept < 1.0) {
        let first = jobs.partition_point(|job| job.joint < u32::from(hung.joint));
        let own = jobs[first..].iter().take_while(|job| job.joint == u32::from(hung.joint));
        for (job, own) in (first..).zip(own) {
            let takers = || {
                let jobs = hung.between.iter().map(|&joint| find_job(jobs, usize::from(joint), own.component));
                jobs.zip(parts).filter_map(|(job, part)| Some((job? as usize, part)))
            };
            let whole: f64 = takers().map(|taker| taker.1).sum();
            let loss = changes[job].loss * (1.0 - kept);
            if whole > 0.0 && whole.is_finite() {
                changes[job].loss -= loss;
                handed_on.extend(takers().map(|(job, part)| (job, loss * (part / whole))));
            }
        }
    }
    for (job, loss) in handed_on {
        changes[job].loss += loss;
    }
}
