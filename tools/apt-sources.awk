# For tools/apt-sources: reads its table of Debian's entries, then apt's source files.

function plain(uri) { # as the table and the files may write one URI differently
    sub(/:\/+/, ":/", uri)
    sub(/\/+$/, "", uri)
    return uri
}

# The suites among `suites` that are Debian's release, its updates or its security updates, renamed.
function renamed(uris, suites,    i, j, m, n, uri, suite, code, result) {
    m = split(uris, uri, " ")
    n = split(suites, suite, " ")
    for (j = 1; j <= n; j++)
        for (i = 1; i <= m; i++) {
            code = codename[file, plain(uri[i]), suite[j]]
            if (code !~ /^[a-z]+(-updates|-security)?$/)
                continue
            if (release ~ /^(unstable|sid|experimental)$/ && code ~ /-/)
                break # it has neither updates nor security updates
            sub(/^[a-z]+/, release, code)
            result = result " " code
            break
        }
    return result
}

function entry(uris, suites, components, options,    new) {
    new = renamed(uris, suites)
    if (new == "" || (uris, new, components) in printed)
        return
    printed[uris, new, components]
    printf "Types: deb\nURIs: %s\nSuites:%s\nComponents: %s\n%s\n", uris, new, components, options
}

function one_line(line,    options, option, value, i, n, text) {
    sub(/#.*/, "", line)
    if (match(line, /\[[^\]]*\]/)) {
        n = split(substr(line, RSTART + 1, RLENGTH - 2), option, " ")
        line = substr(line, 1, RSTART - 1) substr(line, RSTART + RLENGTH)
        for (i = 1; i <= n; i++) {
            split(option[i], value, "=")
            gsub(",", " ", value[2])
            if (value[1] == "arch") value[1] = "architectures"
            if (value[1] == "lang") value[1] = "languages"
            if (value[1] == "target") value[1] = "targets"
            text = text value[1] ": " value[2] "\n"
        }
    }
    n = split(line, option, " ")
    for (i = 4; i <= n; i++)
        options = options (i > 4 ? " " : "") option[i]
    entry(option[2], option[3], options, text)
}

function paragraph(    options, name) {
    if ((" " field["types"] " ") ~ / deb / && field["enabled"] !~ /^(no|false|without|off|disable|0)$/) {
        for (name in field)
            if (name !~ /^(types|uris|suites|components|enabled)$/)
                options = options name ": " field[name] "\n"
        entry(field["uris"], field["suites"], field["components"], options)
    }
    split("", field)
}

NR == FNR {
    split($0, column, "|")
    codename[column[1], plain(column[2]), column[3]] = column[4]
    next
}

FNR == 1 { paragraph() }

FILENAME !~ /\.sources$/ {
    file = FILENAME
    if ($1 == "deb")
        one_line($0)
    next
}

/^#/ { next }
/^[ \t]*$/ { paragraph(); next }
/^[ \t]/ { field[name] = field[name] "\n" $0; next }
{
    name = tolower(substr($0, 1, index($0, ":") - 1))
    value = substr($0, index($0, ":") + 1)
    gsub(/^[ \t]+|[ \t]+$/, "", value)
    field[name] = value
    file = FILENAME
}
END { paragraph() }
