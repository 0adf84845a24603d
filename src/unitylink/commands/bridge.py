# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink bridge`: a robot on ROS topics or on a Zenoh network, with nothing generated."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .bridge_zenoh import ZenohOptions, run_zenoh, zenoh_options
from .failure import Failure
from .link_option import link_argument, load_names, spec_option

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.layer4_data import Node
    from unitylink.spec.model import Spec


@click.command()
@click.argument("network", type=click.Choice(["ros1", "ros2", "zenoh"]))
@link_argument
@click.argument("spec_argument", metavar="[SPEC]", required=False)
@spec_option
@click.option("--root", metavar="NAME", help="Which public constructor, if the spec has several.")
@click.option("--namespace", metavar="NAME", help="Namespace of the topics. By default the robot's name.")
@click.option(
    "--command-timeout",
    type=click.FloatRange(0),
    default=0.0,
    metavar="S",
    help="Write the safe values after S seconds without a command. 0 is never.",
)
@click.option("--disarmed", is_flag=True, help="Take no commands before the service arm is called.")
@click.option(
    "--rmw",
    type=click.Choice(["dds", "zenoh"]),
    help="What carries ROS 2. By default dds, or zenoh if RMW_IMPLEMENTATION is rmw_zenoh_cpp.",
)
@zenoh_options
def command(
    network: str,
    *,
    link: str,
    spec_argument: str | None,
    spec_file: str | None,
    root: str | None,
    namespace: str | None,
    command_timeout: float,
    disarmed: bool,
    rmw: str | None,
    **zenoh: Any,
) -> None:
    """Put a robot on ROS topics or on a Zenoh network until Ctrl-C, with nothing generated.

    All messages are standard ones, which every tool of ROS knows: a std_msgs scalar for each value that is
    published or written, and sensor_msgs/JointState for joints. `unitylink generate SPEC --only ros1` or
    `ros2` makes a package with messages of its own.

    `ros2` needs no ROS on this machine: it speaks DDS, or Zenoh as rmw_zenoh_cpp does, and ROS 2 sees it.
    `ros1` needs rospy and a master.

    `zenoh` lets every machine of a Zenoh network use the robot as if it were its own: LINK is then
    zenoh:NAME there. Its options are --key, --connect, --listen, --zenoh-config, --anyone, --may and --audit.
    The others are for ROS. Several robots: unitylink fleet.

    \b
    Examples:
      unitylink bridge ros2 "serial:/dev/ttyUSB0?baud=3000000" --spec arm.ul
      unitylink bridge ros1 tcp://192.168.1.20:5555 --spec arm.ul --namespace left
      unitylink bridge ros2 "sim:arm.ul?plant=ramp"
      unitylink bridge ros2 serial:/dev/ttyUSB0 arm.ul --rmw zenoh
      unitylink bridge zenoh serial:/dev/ttyUSB0 arm.ul --key lab/arm1
      unitylink bridge zenoh tcp://192.168.1.20:5555 arm.ul --key lab/arm2 --connect tcp/10.0.0.7:7447
      unitylink watch zenoh:lab/arm1
    """
    if spec_argument is not None and spec_file is not None:
        raise click.UsageError(f"the spec is given twice: {spec_argument} and --spec {spec_file}")
    spec, name, file = _spec(link, spec_file or spec_argument, root)
    options = ZenohOptions(**zenoh)
    if network == "zenoh":
        for option, given in (
            ("namespace", namespace),
            ("command-timeout", command_timeout),
            ("disarmed", disarmed),
            ("rmw", rmw),
        ):
            if given:
                raise click.UsageError(
                    f"--{option} is for ROS; a set-point on Zenoh has a time to live of its own"
                )
        options.check()
        click.get_current_context().exit(run_zenoh(link, spec.only(name), file, options))
    if options.given:
        raise click.UsageError(f"{options.given[0]} is for Zenoh; leave it out")
    from unitylink import connect
    from unitylink.layer4_data import load_spec_objects
    from unitylink.ros import plan_interface

    interface = plan_interface(spec, name, standard=True)

    def build(opened: Link) -> Node:
        return load_spec_objects(spec, opened, root=name)

    space = f"/{(namespace or interface.robot).strip('/')}"
    click.echo(
        f"{len(interface.published)} topics out, {len(interface.commanded)} in, below {space}", err=True
    )
    from unitylink.ros.parameters import Parameters

    parameters = Parameters(link, command_timeout, armed=not disarmed)
    if network == "ros1":
        if rmw is not None:
            raise click.UsageError("--rmw is for ros2; leave it out")
        from unitylink.ros.ros1 import run

        code = run(interface, build, connect, parameters, namespace=space, services=False)
    else:
        from unitylink.ros.ros2 import carrier, run_alone

        over = rmw or carrier()
        code = run_alone(interface, build, connect, parameters, namespace=space, services=False, over=over)
    click.get_current_context().exit(code)


def _spec(link: str, spec_file: str | None, root: str | None) -> tuple[Spec, str, str]:
    names = load_names(link, spec_file)
    if names.spec is None:
        raise click.UsageError("the names on the topics come from a spec: add --spec FILE.ul")
    try:
        return names.spec, names.spec.root(root).name, names.source
    except KeyError as error:
        raise Failure(str(error.args[0]), "choose one with --root") from None
