// SPDX-License-Identifier: BSD-3-Clause
//! What the objects of Rust allocate, and how they fail:  probe allocations|errors LINK
//! Only the counter of allocations needs `unsafe`.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use std::{env, io, thread};

use steps::unitylink::{Link, Listener, Result};
use steps::{JointOutputs, Mode, Steps, StepsOutputs, StepsTargetsOutputs};

struct Counting;
static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        System.alloc(layout)
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        System.dealloc(pointer, layout)
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// The first calls may make room that stays. Those after them are counted.
fn count<T>(name: &str, mut call: impl FnMut() -> T) {
    for _ in 0..20 {
        let _ = call();
    }
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    for _ in 0..200 {
        let _ = call();
    }
    println!("{name} {}", ALLOCATIONS.load(Ordering::Relaxed) - before);
}

fn count_allocations(link: &Link) -> Result<()> {
    let robot = Steps::on(link)?;
    let (mut cycle, mut small) = (robot.j[0].cycle(), robot.targets.cycle());
    cycle.open()?;
    small.open()?;
    robot.j[1].mode.write(Mode::idle)?;
    robot.published_pose.start()?;
    count("box", || Box::new(1)); // shows that the hook counts
    count("read", || robot.count.read().unwrap());
    count("read of two words", || robot.big.read().unwrap());
    count("write", || robot.gain.write(1.5).unwrap());
    count("write of two words", || robot.exact.write(1.5).unwrap());
    count("commit", || robot.net.a.write(3).unwrap());
    count("group", || robot.targets.write(&StepsTargetsOutputs::default()).unwrap());
    count("snapshot", || robot.snapshot().unwrap());
    count("cycle", || cycle.exchange(&JointOutputs::default()).unwrap());
    count("cycle of outputs", || small.exchange(&StepsTargetsOutputs::default()).unwrap());
    count("refused", || cycle.exchange(&JointOutputs { target: 9.0, ..Default::default() }).unwrap_err());
    count("poll", || robot.published_pose.poll(|_, _| ()).unwrap());
    Ok(())
}

fn tell<T>(name: &str, done: Result<T>) {
    match done {
        Ok(_) => println!("{name}: 0"),
        Err(error) => println!("{name}: {} {error}", error.status()),
    }
}

fn show_errors(link: &Link) -> Result<()> {
    tell("no port", Link::open("tcp://127.0.0.1:1"));
    tell("no url", Link::open("nonsense"));
    let robot = Steps::on(link);
    tell("robot", robot.as_ref().map(|_| ()).map_err(Clone::clone));
    let robot = robot?;
    tell("range", robot.small.write(101));
    tell("not a number", robot.j[1].target.write(f64::NAN));
    tell("not a member", Mode::try_from(2).and_then(|mode| robot.j[0].mode.write(mode)));
    tell("strange member", robot.j[1].mode.read());
    tell("not started", robot.published_pose.wait(Duration::from_secs(1)));
    tell("empty queue", robot.queue.sample.read());
    tell("queue", robot.published_on_queue_arrival.start());
    // a callback and a write behind a commit from threads of their own
    static COME: AtomicUsize = AtomicUsize::new(0);
    robot.published_pose.start()?;
    let listener = Listener::new(&robot.published_pose, |_, _| {
        COME.fetch_add(1, Ordering::Relaxed);
    });
    thread::scope(|scope| {
        for item in 0..4 {
            let robot = &robot;
            scope.spawn(move || (0..20).for_each(|n| robot.net.a.write(20 * item + n).unwrap()));
        }
    });
    while COME.load(Ordering::Relaxed) < 3 {
        thread::sleep(Duration::from_millis(1));
    }
    println!("ready");
    io::stdin().read_line(&mut String::new()).ok(); // until the board is gone
    tell("lost", robot.count.read());
    tell("lost cycle", robot.cycle().exchange(&StepsOutputs::default()));
    tell("lost write", robot.net.a.write(1));
    while listener.error().is_none() {
        thread::sleep(Duration::from_millis(1));
    }
    tell("lost publishes", listener.error().map_or(Ok(()), Err));
    Ok(())
}

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().collect();
    let link = Link::open(&arguments[2])?;
    match arguments[1].as_str() {
        "allocations" => count_allocations(&link),
        _ => show_errors(&link),
    }
}
