"""What people type: `prunus` and its subcommands, a file each."""
