//! `cargo xtask`: builds, tests and serves the project. `cargo xtask help` lists the commands.

use std::path::PathBuf;
use std::process::ExitCode;

use xtask::fuzz::Build;
use xtask::instructions::{self, Then};
use xtask::{browser, checks, fuzz, serve, web};

const HELP: &str = "\
cargo xtask test               everything that must hold before a change lands (see CONTRIBUTING.md)
cargo xtask web [--api]        builds the page into target/web; --api the JavaScript package into target/npm
cargo xtask serve [PORT]       builds the page and serves it on this machine (default port 8080)
cargo xtask fuzz [SECONDS]     fuzzes each reader and the pipeline for so long (default 600)
cargo xtask instructions       counts the instructions of fixed jobs (needs valgrind); --renew writes them as the new bound
cargo xtask help               this text";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words[..] {
        ["test"] => checks::run_all(),
        ["instructions"] => instructions::check(Then::Compare),
        ["instructions", "--renew"] => instructions::check(Then::Renew),
        ["web"] => web::build_page().map(|folder| eprintln!("the page is in {}", folder.display())),
        ["web", "--api"] => {
            web::build_package().map(|folder| eprintln!("the package is in {}", folder.display()))
        }
        ["serve"] => serve_page(8080),
        ["serve", port] => match port.parse() {
            Ok(port) => serve_page(port),
            Err(_) => Err(format!("{port} is not a port").into()),
        },
        ["browser"] => browser::find().map(|path| eprintln!("{}", path.display())),
        ["fuzz"] => fuzz::run_all(600, Build::Sanitized),
        ["fuzz", seconds] => match seconds.parse() {
            Ok(seconds) => fuzz::run_all(seconds, Build::Sanitized),
            Err(_) => Err(format!("{seconds} is not a number of seconds").into()),
        },
        ["help"] => {
            eprintln!("{HELP}");
            Ok(())
        }
        _ => {
            eprintln!("{HELP}");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn serve_page(port: u16) -> Result<(), xtask::Failure> {
    let folder: PathBuf = web::build_page()?;
    let server = serve::Server::start(&folder, port)?;
    eprintln!("the page is at {}; stop with Ctrl-C", server.address());
    server.wait();
    Ok(())
}
