@echo off
rem The path tracing lab on Windows: runs its programs and its tools in Python. Nothing is installed.
setlocal enableextensions
chcp 65001 >nul
set PYTHONUTF8=1
set "lab_root=%~dp0"
if not exist "%lab_root%chapters" (
    echo lab: chapters are missing beside this file: unpack the whole archive first, then start lab.cmd in its folder >&2
    pause
    exit /b 1
)
set "command=%~1"
set rest=
if "%command%"=="" goto ask
if "%command%"=="help" goto help
if "%command%"=="run" goto run
for %%c in (check report sample diff merge) do if "%command%"=="%%c" goto %%c
echo lab: no command '%command%'; lab help lists them >&2
exit /b 1

:ask
call :list
set chapter=
set /p "chapter=Which chapter is to be rendered (its number)? "
if "%chapter%"=="" exit /b 0
call "%~f0" run %chapter%
pause
exit /b 0

:list
pushd "%lab_root%chapters"
for /d %%f in (*) do echo   %%f
popd
exit /b 0

:run
if "%~2"=="" goto list
set "number=0%~2"
set program=
pushd "%lab_root%build\bin"
for %%f in (%number:~-2%_*.exe) do set "program=%%f"
popd
if "%program%"=="" (
    echo lab: there is no chapter '%~2'; lab run lists them >&2
    exit /b 1
)
for /f "tokens=2*" %%a in ("%*") do set "rest=%%b"
"%lab_root%build\bin\%program%" %rest%
exit /b %errorlevel%

:merge
for /f "tokens=1*" %%a in ("%*") do set "rest=%%b"
"%lab_root%build\bin\merge_images.exe" %rest%
exit /b %errorlevel%

:check
:report
:sample
:diff
set python=
for %%p in (py.exe python.exe) do if not defined python if not "%%~$PATH:p"=="" set "python=%%p"
if not defined python (
    echo lab: '%command%' needs Python 3: install it from python.org, then run: python -m pip install numpy scipy matplotlib pillow >&2
    exit /b 1
)
%python% -B "%lab_root%tools" %*
exit /b %errorlevel%

:help
echo Usage: lab COMMAND, with COMMAND one of
echo   run N [ARGUMENTS]       renders with chapter N; --help lists its options
echo   run                     lists the chapters
echo   merge A.exr B.exr ... -o C.exr    joins renders of different samples of the same picture
echo These need Python 3 with numpy, scipy, matplotlib and pillow (python -m pip install ...), and tell more with --help:
echo   check N [FILE]          grades a shader of chapter N: correct, biased or noisy
echo   diff N                  the lesson of chapter N: what its shaders change of the chapter before, and what they add
echo   sample NAME [...]       plots points of a sampler and what they integrate
echo   report [SCENE or N ...] error against time of chapters and scenes
exit /b 0
