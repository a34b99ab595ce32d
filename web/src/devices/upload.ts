/** The command that sends a recorded drive; for a shell, one option a line. */
export function uploadCommand(id: string, key: string, server: string): string {
  return [`livella upload drive.csv`, `--server ${server}`, `--device ${id}`, `--key ${key}`].join(" \\\n  ");
}
