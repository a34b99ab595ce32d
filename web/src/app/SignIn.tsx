import { Button, PasswordInput, Stack } from "@mantine/core";
import { type FormEvent, useState } from "react";
import { Problem } from "../api/http";
import { useSignIn } from "../api/session";
import { problemText } from "../lib/problem";
import { t } from "../text";
import { LanguageSwitch } from "./LanguageSwitch";
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
        <p>{t("shell.motto")}</p>
        <form onSubmit={submit}>
          <Stack>
            <PasswordInput
              label={t("shell.key")}
              description={t("shell.key_about")}
              value={key}
              onChange={(event) => setKey(event.currentTarget.value)}
              error={signIn.error && refusal(signIn.error)}
              autoComplete="current-password"
              autoCapitalize="off"
              spellCheck={false}
              errorProps={{ role: "alert" }}
              visibilityToggleButtonProps={{ "aria-label": t("shell.show_key") }}
              required
            />
            <Button type="submit" size="lg" loading={signIn.isPending} fullWidth>
              {t("shell.sign_in")}
            </Button>
          </Stack>
        </form>
        <LanguageSwitch />
      </div>
    </main>
  );
}

function refusal(error: Error): string {
  return error instanceof Problem && error.status === 401 ? t("shell.key_unknown") : problemText(error);
}
