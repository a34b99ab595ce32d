import { Button, PasswordInput, Stack } from "@mantine/core";
import { type FormEvent, useState } from "react";
import { Problem } from "../api/http";
import { useSignIn } from "../api/session";
import { Logo } from "./Logo";
import css from "./shell.module.css";

/** The door: one key, and the session lives in a cookie that scripts cannot read. */
export function SignIn() {
  const [key, setKey] = useState("");
  const signIn = useSignIn();
  const submit = (event: FormEvent) => {
    event.preventDefault();
    if (key.trim()) signIn.mutate(key.trim());
  };
  return (
    <main className={css.signIn}>
      <div className="card">
        <h1>
          <Logo size={32} />
          Livella
        </h1>
        <p>How is the box mounted? Drive, and see.</p>
        <form onSubmit={submit}>
          <Stack>
            <PasswordInput
              label="Key"
              description="From your administrator; the first one is printed when the service starts for the first time. A device’s own key shows that device."
              value={key}
              onChange={(event) => setKey(event.currentTarget.value)}
              error={signIn.error && refusal(signIn.error)}
              autoComplete="current-password"
              autoCapitalize="off"
              spellCheck={false}
              errorProps={{ role: "alert" }}
              visibilityToggleButtonProps={{ "aria-label": "Show the key" }}
              required
            />
            <Button type="submit" size="lg" loading={signIn.isPending} fullWidth>
              Sign in
            </Button>
          </Stack>
        </form>
      </div>
    </main>
  );
}

function refusal(error: Error): string {
  if (!(error instanceof Problem) || error.status === 0) return error.message;
  if (error.status === 401) return "This key is not known. Check that it was copied whole.";
  return error.message;
}
