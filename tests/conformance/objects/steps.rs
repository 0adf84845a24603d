// SPDX-License-Identifier: BSD-3-Clause
//! The steps in Rust. steps.py, steps.cpp and steps.c do the same and print the same lines.
#![forbid(unsafe_code)]

use std::convert::TryFrom;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use steps::unitylink::{Link, Result, UL_RANGE};
use steps::{JointInputs, JointOutputs, Level, Mode, Status, Steps, StepsTargetsOutputs};

static STEP: AtomicUsize = AtomicUsize::new(0);

fn say(name: &str, text: String) {
    println!("{:02} {name}: {text}", STEP.fetch_add(1, Ordering::Relaxed) + 1);
}

fn refused<T>(name: &str, done: Result<T>) {
    let told = match done {
        Ok(_) => "done",
        Err(error) if error.status() == UL_RANGE => "refused",
        Err(_) => "unexpected",
    };
    say(name, told.to_string());
}

fn say_status(name: &str, status: &Status) {
    say(name, format!("{} {} {:.1}", status.ready as u8, status.mode as u8, status.heat));
}

fn whole(robot: &Steps) -> Result<()> {
    robot.count.write(123456)?;
    say("count", robot.count.read()?.to_string());
    robot.count.write(4294967295)?;
    say("count", robot.count.read()?.to_string());
    robot.small.write(-100)?;
    say("small", robot.small.read()?.to_string());
    refused("small 101", robot.small.write(101));
    refused("small -101", robot.small.write(-101));
    say("small", robot.small.read()?.to_string());
    robot.big.write(18446744073709551615)?;
    say("big", robot.big.read()?.to_string());
    robot.big.write(81985529216486895)?;
    say("big", robot.big.read()?.to_string());
    Ok(())
}

fn real(robot: &Steps) -> Result<()> {
    robot.gain.write(2.5)?;
    say("gain", format!("{:.6}", robot.gain.read()?));
    refused("gain 10.5", robot.gain.write(10.5));
    refused("gain NaN", robot.gain.write(f64::NAN));
    robot.exact.write(-0.1)?;
    let exact = robot.exact.read()?;
    say("exact", format!("{exact:.17}")); // as many digits as %.17g of a number from 0.1 to 1
    refused("exact infinite", robot.exact.write(f64::INFINITY));
    robot.j[0].torque.write(1.503)?;
    say("torque", format!("{:.8}", robot.j[0].torque.read()?));
    robot.j[1].torque.write(99.0)?;
    say("torque", format!("{:.8}", robot.j[1].torque.read()?));
    robot.j[1].torque.write(-99.0)?;
    say("torque", format!("{:.8}", robot.j[1].torque.read()?));
    robot.j[0].target.write(-1.2345)?;
    refused("target 3.5", robot.j[0].target.write(3.5));
    say("pos", format!("{:.3} {:.3}", robot.j[0].pos.read()?, robot.j[1].pos.read()?));
    Ok(())
}

fn named(robot: &Steps) -> Result<()> {
    robot.j[0].mode.write(Mode::stop)?;
    say("mode", (robot.j[0].mode.read()? as u8).to_string());
    refused("mode 2", Mode::try_from(2).and_then(|mode| robot.j[0].mode.write(mode)));
    refused("mode of the board", robot.j[1].mode.read());
    robot.level.write(Level::high)?;
    say("level", robot.level.read()?.0.to_string());
    robot.level.write(Level(200))?;
    say("level", robot.level.read()?.0.to_string());
    robot.status.write(Status { ready: true, mode: Mode::run, heat: -12.5 })?;
    say_status("status", &robot.status.read()?);
    refused("status hot", robot.status.write(Status { ready: true, mode: Mode::run, heat: 64.0 }));
    let mut lamps = [0; 3];
    for (item, lamp) in [true, false, true].into_iter().enumerate() {
        robot.lamps[item].write(lamp)?;
        lamps[item] = robot.lamps[item].read()? as u8;
    }
    say("lamps", format!("{} {} {}", lamps[0], lamps[1], lamps[2]));
    Ok(())
}

fn say_net(robot: &Steps) -> Result<()> {
    say("net", format!("{} {:.1}", robot.net.a.read()?, robot.net.b.read()?));
    Ok(())
}

fn special(robot: &Steps) -> Result<()> {
    say("faults", robot.faults.read()?.to_string());
    robot.faults.clear(4)?;
    say("faults", robot.faults.read()?.to_string());
    say("lost", robot.lost.read()?.to_string());
    robot.reset.pulse(3)?;
    say("reset", "pulsed".to_string());
    refused("reset 16", robot.reset.pulse(16));
    robot.net.a.write(-7)?;
    say_net(robot)?;
    robot.net.b.write(12.3)?;
    say_net(robot)?;
    robot.net.a.write(8)?;
    say_net(robot)
}

fn say_joint(name: &str, state: &JointInputs) {
    say(name, format!("{:.3} {} {:.3}", state.pos, state.mode as u8, state.torque));
}

fn together(robot: &Steps) -> Result<()> {
    robot.targets.write(&StepsTargetsOutputs { j_0_target: 0.25, j_1_target: -0.25 })?;
    say("limit", robot.limit.read()?.to_string());
    robot.j[1].mode.write(Mode::idle)?;
    let mut cycle = robot.j[0].cycle();
    say_joint("cycle", &cycle.exchange(&JointOutputs { target: 1.5, mode: Mode::run, torque: -2.25 })?);
    refused("cycle 4", cycle.exchange(&JointOutputs { target: 4.0, mode: Mode::idle, torque: 0.0 }));
    say_joint("cycle", &cycle.exchange(&JointOutputs { target: -1.5, mode: Mode::stop, torque: 50.0 })?);
    let shot = robot.snapshot()?;
    let numbers = format!("{} {} {} {:.3}", shot.count, shot.small, shot.big, shot.gain);
    say("snapshot", format!("{numbers} {:.3}", shot.j[1].torque));
    robot.published_pose.start()?;
    robot.published_pose.wait(Duration::from_secs(10))?;
    let mut first = None;
    robot.published_pose.poll(|_, pose| {
        first.get_or_insert(pose.j_1_pos);
    })?;
    say("published", first.map_or("nothing".to_string(), |pos| format!("{pos:.3}")));
    Ok(())
}

fn main() -> Result<()> {
    let url = std::env::args().nth(1).unwrap_or_default();
    let robot = Steps::on(&Link::open(&url)?)?;
    for part in [whole, real, named, special, together] {
        part(&robot)?;
    }
    Ok(())
}
