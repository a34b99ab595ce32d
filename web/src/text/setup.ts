/** Before the tests: they read what an Englishman reads. */
import { startText } from ".";

await startText("en");
