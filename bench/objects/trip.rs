// SPDX-License-Identifier: BSD-3-Clause
//! Round trips through typed objects of Rust:  trip LINK
//! For each line "KIND COUNT" on standard input it makes COUNT of them, and prints their times in ns on one line. KIND
//! is read-objects or cycle-objects, as in trip.cpp.
#![forbid(unsafe_code)]

use std::io::stdin;
use std::time::Instant;

use walker::unitylink::{Link, Result};
use walker::{Walker, WalkerOutputs};

fn measure(count: usize, mut trip: impl FnMut() -> Result<()>) -> Result<()> {
    let mut times = Vec::with_capacity(count);
    for _ in 0..count {
        let start = Instant::now();
        trip()?;
        times.push(start.elapsed().as_nanos());
    }
    let told: Vec<String> = times.iter().map(u128::to_string).collect();
    println!("{}", told.join(" "));
    Ok(())
}

fn main() -> Result<()> {
    let robot = Walker::on(&Link::open(&std::env::args().nth(1).unwrap_or_default())?)?;
    let mut cycle = robot.cycle();
    cycle.open()?;
    let mut outputs = WalkerOutputs::default();
    let mut sum = 0.0; // of all that is read, so that no read is left out
    for line in stdin().lines().map_while(std::io::Result::ok) {
        let (kind, count) = line.split_once(' ').unwrap_or(("", "0"));
        let count = count.trim().parse().unwrap_or(0);
        if kind == "read-objects" {
            measure(count, || {
                sum += robot.position[0].read()?;
                Ok(())
            })?;
        } else {
            measure(count, || {
                outputs.target[0] = -outputs.target[0] + 0.5;
                let inputs = cycle.exchange(&outputs)?;
                sum += inputs.position[0] + inputs.position[17];
                Ok(())
            })?;
        }
    }
    eprintln!("{sum}");
    Ok(())
}
