# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# fish completion for iio-angle. The program itself says what may stand next.

function __iio_angle_candidates
    set -l words (commandline -opc) (commandline -ct)
    for line in ($words[1] complete -- $words[2..-1] 2>/dev/null)
        if test "$line" = ":files"
            __fish_complete_path (commandline -ct)
        else
            echo $line
        end
    end
end

complete -c iio-angle -f -a '(__iio_angle_candidates)'
