//! The arguments of `g7 serve`.

use std::net::IpAddr;
use std::path::PathBuf;

use clap::Args;

use crate::station::Drive;

#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  g7 serve                          the charts in this folder and below
  g7 serve examples                 those of a folder
  g7 serve tank/chart.g7            a folder, with one chart opened
  g7 serve --read-only examples     for looking, not for changing
  g7 serve --host 0.0.0.0 --cert g7.cert.pem --key g7.key.pem --users g7.users
                                    for others, who log in (`g7 cert`, `g7 users`)
  g7 serve sorter.g7 --online       drives the devices of sorter.io.toml, with the page
                                    of the operator: start, stop, values, forcing
  g7 serve sorter.g7 --online --simulate   the same, with the plant in place of devices

The address printed has a token that is made anew at each start: whoever has it
reads and writes the charts of the folder, nobody else does, and nothing outside
the folder is touched. A page that is open goes on when the server of its folder is
started again within 8 hours at the same port; --forget ends that. With --users there is no token: people log in, and each does
what the role allows. An address that other machines reach needs users and TLS.
Ctrl-C ends the server; with --online the outputs are safe then.")]
pub(crate) struct Serve {
    /// A folder with charts, or one chart.
    #[arg(default_value = ".", value_name = "FILE or FOLDER")]
    pub(super) path: PathBuf,
    /// The port [default: 4700, or another one if that is taken].
    #[arg(long, value_name = "NUMBER")]
    pub(super) port: Option<u16>,
    /// The address to listen at [default: 127.0.0.1, only this machine].
    #[arg(long, visible_alias = "listen", value_name = "ADDRESS")]
    pub(super) host: Option<IpAddr>,
    /// The file of the users; it is made if it is missing.
    #[arg(long, value_name = "FILE")]
    pub(super) users: Option<PathBuf>,
    /// The certificate for encrypted connections (PEM).
    #[arg(long, value_name = "FILE", requires = "key")]
    pub(super) cert: Option<PathBuf>,
    /// The private key of the certificate (PEM).
    #[arg(long, value_name = "FILE", requires = "cert")]
    pub(super) key: Option<PathBuf>,
    /// The log of events and of what people do; it is made if it is missing.
    #[arg(long, value_name = "FILE")]
    pub(super) log: Option<PathBuf>,
    /// Write nothing; charts can still be viewed and run.
    #[arg(long)]
    pub(super) read_only: bool,
    /// Let in no page of an earlier start: each needs the address that is printed now.
    #[arg(long, conflicts_with = "users")]
    pub(super) forget: bool,
    /// Print an address for guests too: whoever has it looks at charts and runs, and changes nothing.
    #[arg(long, conflicts_with = "online")]
    pub(super) guests: bool,
    /// Do not open a browser; only print the address.
    #[arg(long)]
    pub(super) no_open: bool,
    /// Let VS Code show the page in a panel; without it no other page may frame it. ADDRESS is that of a VS Code in
    /// the browser.
    #[arg(
        long,
        value_name = "ADDRESS",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "",
        conflicts_with_all = ["host", "users", "online"]
    )]
    pub(super) framed: Option<String>,
    /// The chart to open first, as its path in the folder.
    #[arg(long, value_name = "FILE")]
    pub(super) start: Option<String>,
    #[command(flatten)]
    pub(super) drive: Drive,
    /// With --online: the plant to use if there are several.
    #[arg(long, value_name = "NAME", requires = "online")]
    pub(super) plant: Option<String>,
    /// Read the page from this folder (for its development).
    #[arg(long, value_name = "FOLDER", hide = true)]
    pub(super) page_dir: Option<PathBuf>,
}
