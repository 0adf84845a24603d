// SPDX-License-Identifier: BSD-3-Clause
//! Holds the joint at an angle, 1000 times a second:  loop LINK ANGLE SECONDS
#![forbid(unsafe_code)]

use std::{env, error::Error, thread, time::Duration, time::Instant};

use joint::unitylink::Link;
use joint::{Joint, JointInputs, JointOutputs};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().collect();
    let [_, url, angle, seconds] = <[String; 4]>::try_from(arguments).map_err(|_| "usage: loop LINK ANGLE SECONDS")?;
    let (wanted, cycles) = (angle.parse::<f64>()?, (1000.0 * seconds.parse::<f64>()?) as u32);
    let link = Link::open(&url)?;
    let robot = Joint::on(&link)?; // checks that the board has this spec
    link.set_dead_man(Duration::from_secs(1))?; // then the torque is its SAFE value
    let mut cycle = robot.cycle();
    cycle.open()?; // from here on nothing is allocated
    let mut out = JointOutputs::default(); // each output has its INITIAL
    let mut now = JointInputs::default();
    let begin = Instant::now();
    for number in 1..=cycles {
        now = cycle.exchange(&out)?; // one message each way
        out.torque = (8.0 * (wanted - now.angle) - 0.6 * now.speed).clamp(-2.0, 2.0);
        let due = begin + Duration::from_millis(number.into());
        thread::sleep(due.saturating_duration_since(Instant::now()));
    }
    robot.torque.write(0.0)?;
    println!("{cycles} cycles, the angle is {:.3} rad", now.angle);
    Ok(())
}
