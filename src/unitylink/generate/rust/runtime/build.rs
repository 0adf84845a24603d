// SPDX-License-Identifier: BSD-3-Clause

//! Tells the linker where libunitylink is: in UNITYLINK_LIB_DIR, or where pkg-config finds it.

use std::{env, process::Command};

fn main() {
    println!("cargo:rerun-if-env-changed=UNITYLINK_LIB_DIR");
    println!("cargo:rerun-if-env-changed=PKG_CONFIG_PATH");
    println!("cargo:rustc-link-lib=dylib=unitylink");
    if let Some(folder) = env::var_os("UNITYLINK_LIB_DIR") {
        println!("cargo:rustc-link-search=native={}", folder.to_string_lossy());
        return;
    }
    let found = Command::new("pkg-config").args(["--variable=libdir", "unitylink"]).output();
    match found {
        Ok(told) if told.status.success() => {
            // it writes a space as in a shell
            let folder = String::from_utf8_lossy(&told.stdout).trim().replace("\\ ", " ");
            println!("cargo:rustc-link-search=native={folder}");
        }
        _ => println!(
            "cargo:warning=pkg-config does not find unitylink: install the library, or name the folder of \
             libunitylink.so in UNITYLINK_LIB_DIR"
        ),
    }
}
