// Prints what the Khronos validator finds in each file; exit status 1 when any has an error.
import {readFile} from 'node:fs/promises';
import validator from 'gltf-validator';

let errors = 0;
for (const file of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), {maxIssues: 50});
  const {numErrors, numWarnings, messages} = report.issues;
  errors += numErrors;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings`);
  for (const m of messages)
    if (m.severity <= 1) console.log(`  ${m.code} ${m.pointer ?? ''}: ${m.message}`);
}
process.exit(errors > 0 ? 1 : 0);
